"""Commands that do not fit are counted and refused, and the run goes on in its defined hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.codec.codecs import CommandCodec, encode_string
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, JOINT_COMMAND, WRENCH_COMMAND
from space_robot_sim.nodes import command_port
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import but_for_publishers

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
WITHOUT_CONTROLLER = ("recorder", "guidance", "simulator")
PERIOD = 250_000_000


def command(
    robot: RunningGraph, stamp: int, effort: float = 0.0, names: tuple[str, ...] | None = None
) -> tuple[bytes, ...]:
    names = names or robot.composition.joint_names
    return CommandCodec(names).encode(Command(stamp, np.zeros(6), np.full(len(names), effort)))


def publish(robot: RunningGraph, parts: tuple[bytes, ...]) -> None:
    robot.publish(WRENCH_COMMAND, parts[0])
    robot.publish(JOINT_COMMAND, parts[1])


def poisoned(parts: tuple[bytes, ...]) -> tuple[bytes, ...]:
    """The last joint effort becomes NaN on the wire."""
    return parts[0], parts[1][:-8] + np.array([np.nan]).tobytes()


@pytest.mark.parametrize(
    ("fault", "names", "poison"),
    [
        ("wrong names", ("a", "b", "c", "d"), False),
        ("wrong size", ("a", "b", "c"), False),
        ("not a number", None, True),
    ],
)
def test_an_unusable_answer_is_refused_and_held(
    tmp_path: Path, fault: str, names: tuple[str, ...] | None, poison: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wrong names, wrong size or NaN at the awaited stamp: counted once, the plant holds the last valid command."""
    monkeypatch.setattr(command_port, "SECOND_CHANCE", 0.01)
    with running_graph(tmp_path / "run", roles=WITHOUT_CONTROLLER) as robot:
        publish(robot, command(robot, 0, effort=0.05))
        robot.spin_until(lambda: robot.simulator.tick == 1, "the first step")
        bad = command(robot, PERIOD, names=names)
        publish(robot, poisoned(bad) if poison else bad)
        robot.spin_until(lambda: robot.simulator.tick == 2, f"the step in spite of {fault}")
        assert robot.simulator.commands.counts["invalid"] == 1
        sample = robot.simulator.sample
        assert sample is not None
        np.testing.assert_array_equal(sample.telemetry["applied_effort"], 0.05)
        publish(robot, command(robot, 2 * PERIOD, effort=0.01))
        robot.spin_until(lambda: robot.simulator.tick == 3, "the next step")
        sample = robot.simulator.sample
        assert sample is not None
        np.testing.assert_array_equal(sample.telemetry["applied_effort"], 0.01)


@pytest.mark.parametrize(("shift", "count"), [(-PERIOD, "stale"), (PERIOD, "future"), (17, "future")])
def test_a_stamp_out_of_step_is_refused_and_the_run_waits(tmp_path: Path, shift: int, count: str) -> None:
    """A stale or future stamp moves nothing; the right one, later, moves the plant."""
    with running_graph(tmp_path / "run", roles=WITHOUT_CONTROLLER) as robot:
        publish(robot, command(robot, 0))
        robot.spin_until(lambda: robot.simulator.tick == 1, "the first step")
        publish(robot, command(robot, PERIOD + shift, effort=0.01))
        counts = robot.simulator.commands.counts
        # Of an answer to state 0 the wrench is the one that was accepted.
        robot.spin_until(lambda: counts[count] + counts["repeated"] == 2, f"both parts counted as {count}")
        assert robot.simulator.tick == 1
        publish(robot, command(robot, PERIOD))
        robot.spin_until(lambda: robot.simulator.tick == 2, "the step after the right answer")


def test_garbage_on_the_wire_is_counted_and_moves_nothing(tmp_path: Path) -> None:
    """Bytes that are no message at all neither stop nor advance the run."""
    with running_graph(tmp_path / "run", roles=WITHOUT_CONTROLLER) as robot:
        robot.publish(WRENCH_COMMAND, b"\x00\x01\x00\x00\x01\x02")
        robot.spin_until(lambda: robot.simulator.commands.counts["malformed"] == 1, "the garbage to be counted")
        assert robot.simulator.tick == 0
        assert robot.simulator.failure is None


@pytest.mark.parametrize("text", ["no event", '{"stamp": 17, "kind": "a"}', '{"stamp": 0, "kind": "a", "x": NaN}'])
def test_an_odd_event_is_not_recorded(tmp_path: Path, text: str) -> None:
    """What a stranger says on controller/events that is none, or of no tick, is counted; the run and its log go on."""
    with running_graph(tmp_path / "run", "duration=20.0", realtime=0.001) as robot:
        robot.publish(CONTROLLER_EVENTS, encode_string(text))
        robot.spin_until(lambda: robot.recorder.malformed == 1, "the odd event to be counted")
        assert robot.recorder.failure is None
    assert "controller/events" not in {name for name, _, _ in but_for_publishers(tmp_path / "run")}


def test_a_stranger_cannot_derail_a_controlled_run(tmp_path: Path) -> None:
    """With a second publisher shouting stale and future commands the run ends completed."""
    with running_graph(tmp_path / "run", "duration=20.0") as robot:
        for tick in (0, 5, 70, 10_000):
            publish(robot, command(robot, 40 * PERIOD + tick))
        robot.spin_until(lambda: robot.recorder.complete and robot.simulator.end_reason, "the end of the run")
        assert robot.simulator.end_reason == "completed"
