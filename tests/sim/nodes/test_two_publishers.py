"""More than one node commands: one valid answer acts, whole, and the log has that one and who spoke."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from itertools import chain, pairwise
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
from rclpy.node import Node
from rclpy.parameter import Parameter

from space_robot_bringup.modes.graph import LIGHT
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.codec.codecs import CommandCodec, peek_stamp
from space_robot_msgs_py.codec.layout import LayoutBuilder
from space_robot_msgs_py.codec.sender_mark import SenderMark, mark_of
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Command, Tick
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_COMMAND
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import assert_equal, replayed
from tests.support.unanswered import AT, EFFORT, PERIOD, SHORT, controller_of, foreign, go_on, publish, stand_unanswered

SECONDS = 30.0

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


def ticks_of(place: Path) -> list[Tick]:
    """All ticks of a log, each of which is complete."""
    ticks = list(LogReader(place).ticks())
    assert [tick.stamp for tick in ticks] == [PERIOD * k for k in range(len(ticks))]
    return ticks


def assert_recorded_as_applied(place: Path) -> None:
    """What the plant says acted is what is recorded, at every tick; a plant given the record makes the same states."""
    ticks = ticks_of(place)
    for before, after in pairwise(ticks):
        assert after.sample.telemetry["command_stamp"] == before.stamp
        if not after.sample.telemetry["saturation"].any():
            np.testing.assert_array_equal(after.sample.telemetry["applied_effort"], before.output.command.effort)
    (plant,) = replayed(place, against="plant").outcomes
    assert (plant.first, plant.absent) == (None, ())


def is_foreign(tick: Tick, effort: float = EFFORT) -> tuple[bool, bool]:
    """Whether wrench and efforts are the stranger's."""
    command = tick.output.command
    return not command.wrench.any(), bool((command.effort == effort).all())


def events(place: Path) -> list[dict[str, Any]]:
    raws = [raw for name, _, raw in LogReader(place).messages() if name == "controller/events"]
    return [json.loads(line) for raw in raws for line in raw[8:].rstrip(b"\0").decode().split("\n")]


def test_half_a_command_of_a_stranger_is_no_half_of_a_command(tmp_path: Path) -> None:
    """A valid half that waits for its other half does not become part of the controller's command, nor of its log."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        stand_unanswered(robot)
        robot.publish(JOINT_COMMAND, foreign(robot, AT * PERIOD)[1])
        robot.settle()
        go_on(robot)
    assert is_foreign(ticks_of(tmp_path / "run")[AT]) == (False, False)
    # The event that names the stranger is nothing that a replay would have to do again.
    assert_equal(tmp_path / "run")
    assert_recorded_as_applied(tmp_path / "run")
    (event,) = [one for one in events(tmp_path / "run") if one["topic"] == "joint_command"]
    assert event == {
        "stamp": AT * PERIOD,
        "kind": "publishers",
        "topic": "joint_command",
        "nodes": ["/controller", "/stranger"],
    }


def test_the_first_valid_answer_to_a_state_acts_and_is_recorded(tmp_path: Path) -> None:
    """An invalid answer uses nothing up, of two valid ones the first acts, and a late other one is not recorded."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        stand_unanswered(robot)
        publish(robot, poisoned(foreign(robot, AT * PERIOD)))
        robot.settle()
        assert robot.simulator.commands.counts["invalid"] == 1
        # The recorder hears all of what follows after the simulator, in another order.
        robot.executor.remove_node(robot.recorder)
        publish(robot, foreign(robot, AT * PERIOD))
        robot.spin_until(lambda: robot.simulator.commands.answered, "the stranger's answer")
        controller_of(robot).trigger_activate()
        robot.settle()
        publish(robot, foreign(robot, AT * PERIOD, 2 * EFFORT))
        robot.executor.add_node(robot.recorder)
        robot.settle()
        go_on(robot)
    ticks = ticks_of(tmp_path / "run")
    assert len(ticks) == 21
    assert [is_foreign(tick) for tick in ticks] == [(k == AT, k == AT) for k in range(21)]
    assert_recorded_as_applied(tmp_path / "run")


def poisoned(parts: tuple[bytes, ...]) -> tuple[bytes, ...]:
    """The last joint effort becomes NaN on the wire."""
    return parts[0], parts[1][:-8] + np.array([np.nan]).tobytes()


class Overheard:
    """All commands that anything published, by stamp and mark."""

    def __init__(self, robot: RunningGraph) -> None:
        self._codec = CommandCodec(robot.composition.joint_names)
        self._marks = SenderMark(self._codec.layouts)
        self.parts: dict[tuple[int, bytes], dict[int, list[bytes]]] = {}
        for index, topic in enumerate(self._codec.topics):
            robot.stranger.listen(topic, lambda raw, index=index: self._take_in(index, raw))

    def _take_in(self, index: int, raw: bytes) -> None:
        parts = self.parts.setdefault((peek_stamp(raw), self._marks.read(index, raw)), {})
        parts.setdefault(index, []).append(self._marks.remove(index, raw))

    def commands(self, stamp: int) -> list[bytes]:
        """Generalised force of every whole command of a stamp."""
        found = [parts for (heard, _), parts in self.parts.items() if heard == stamp]
        return [self._codec.decode((parts[0][0], parts[1][0])).u.tobytes() for parts in found]


@pytest.mark.parametrize("shipped", [True, False])
def test_two_controllers_never_make_one_command(shipped: bool, tmp_path: Path) -> None:
    """With a second one that answers every state the run completes, every command is one controller's, and recorded."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        robot.simulator.pause(True)
        overheard = Overheard(robot)
        if shipped:
            second = second_controller(robot)
            # Else the run of twenty ticks may be over before the middleware brings it anything.
            robot.spin_until(lambda: second.begun, "the answer of the second one")
        else:
            robot.stranger.listen(BASE_ODOM, lambda raw: publish(robot, foreign(robot, peek_stamp(raw))))
        robot.await_answer()
        robot.simulator.pause(False)
        robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
        robot.spin_until(lambda: robot.recorder.complete, "the last tick")
        robot.recorder.finish("completed")
        robot.settle()
        if shipped:
            second.destroy_node()
    for tick in ticks_of(tmp_path / "run"):
        assert tick.output.command.u.tobytes() in overheard.commands(tick.stamp)
        assert len(overheard.commands(tick.stamp)) == 2
    assert_recorded_as_applied(tmp_path / "run")
    names = ["/controller", "/second" if shipped else "/stranger"]
    found = {one["topic"]: one["nodes"] for one in events(tmp_path / "run") if one["kind"] == "publishers"}
    assert found["base/wrench_command"] == found["joint_command"] == names


def second_controller(robot: RunningGraph) -> ControllerNode:
    """A shipped controller beside the one of the run, with another gain."""
    node = ControllerNode(
        robot.composition.controller, robot.composition.joint_names, name="second", context=robot.context, **LIGHT
    )
    bring_up([node])
    node.set_parameters([Parameter("gains.kappa", value=0.5)])
    # Nothing turns meanwhile: what guidance sends ahead of the states, a node that comes later never hears.
    deadline = monotonic() + SECONDS
    while not _all_hear_all((*robot.nodes.values(), robot.stranger, node)):
        assert monotonic() < deadline, "the second one is not discovered"
        sleep(0.005)
    robot.executor.add_node(node)
    return node


def _all_hear_all(nodes: Sequence[Node]) -> bool:
    """Whether every publisher has discovered every reader of its topic, and the readers have discovered it."""
    writers, readers = (
        [*chain(*ends)] for ends in zip(*((one.publishers, one.subscriptions) for one in nodes), strict=True)
    )
    written, read = (Counter(one.topic_name for one in ends) for ends in (writers, readers))
    known = [one.get_subscription_count() >= read[one.topic_name] for one in writers]
    return all(known) and all(one.get_publisher_count() >= written[one.topic_name] for one in readers)


def test_a_run_in_lock_step_refuses_nothing(tmp_path: Path) -> None:
    """A controller that is held, and one that is configured anew, answer each state once; no answer is stale."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        overheard = Overheard(robot)
        stand_unanswered(robot)
        controller = controller_of(robot)
        controller.trigger_cleanup()
        controller.trigger_configure()
        robot.settle()
        go_on(robot)
        robot.settle()
        assert not robot.simulator.commands.counts
        assert not any(node.refusals for node in robot.nodes.values())
    assert sorted(stamp for stamp, _ in overheard.parts) == [PERIOD * k for k in range(21)]
    assert all([len(heard) for heard in parts.values()] == [1, 1] for parts in overheard.parts.values())


def test_an_answer_that_comes_twice_is_refused_without_a_word(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Stamps that were answered stay answered: the same again is counted, and only another answer is logged."""
    with running_graph(tmp_path / "run", SHORT, roles=("recorder", "guidance", "simulator")) as robot:
        publish(robot, foreign(robot, 0))
        robot.spin_until(lambda: robot.simulator.tick == 1, "the first step")
        publish(robot, foreign(robot, 0))
        robot.settle()
        assert robot.simulator.commands.counts == {"repeated": 2}
        assert "as stale" not in capfd.readouterr().err
        publish(robot, foreign(robot, 0, 2 * EFFORT))
        robot.settle()
        assert (
            "as stale: stamp 0 ns is older than the state at 250000000 ns; published by /stranger"
            in capfd.readouterr().err
        )


def test_a_late_command_of_an_answered_period_does_not_act_again(tmp_path: Path) -> None:
    """Paced: of late commands the newest acts, and none of a period that had its command."""
    with running_graph(tmp_path / "run", SHORT, roles=("recorder", "guidance", "simulator"), realtime=0.001) as robot:
        robot.spin_until(lambda: robot.simulator.started, "the start")
        applied = []
        for tick, said in enumerate([((0, 1.0),), ((0, 2.0),), ((2, 3.0), (1, 4.0)), ((2, 5.0),)]):
            for stamp, factor in said:
                publish(robot, foreign(robot, stamp * PERIOD, factor * EFFORT))
            robot.settle()
            robot.simulator._on_period()
            sample = robot.simulator.sample
            assert sample is not None
            applied.append((tick, sample.telemetry["applied_effort"][0] / EFFORT))
    # In the second period nothing new was there; the last valid command is held.
    assert [round(effort, 6) for _, effort in applied] == [1.0, 1.0, 3.0, 4.0]


def test_a_mark_is_there_for_the_simulator_alone() -> None:
    """A marked command is the same message to every reader, and without its mark the same bytes."""
    names = ("a", "b")
    codec = CommandCodec(names)
    marks, command = SenderMark(codec.layouts), Command(PERIOD, np.arange(6.0), np.array([0.5, -0.5]))
    plain, mark = codec.encode(command), mark_of(b"\x01\x0f" * 8)
    marked = marks.put(plain, mark)
    assert marked != plain
    assert [marks.read(k, raw) for k, raw in enumerate(marked)] == [mark, mark]
    assert tuple(marks.remove(k, raw) for k, raw in enumerate(marked)) == plain
    np.testing.assert_array_equal(codec.decode(marked).u, command.u)
    assert marks.remove(0, marked[0] + b"\0") == marked[0] + b"\0"
    with pytest.raises(LayoutError, match="no padding"):
        SenderMark([LayoutBuilder("base/odom").stamp().doubles(1, "x").build()])
