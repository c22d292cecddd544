"""Paced: answers that are late are in the log where they may act, and a replay knows of those that are not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.codec.codecs import TickCodec
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, JOINT_COMMAND, PLANT_TELEMETRY
from space_robot_sim.nodes.tick_parts import MAX_LATE
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import replayed
from tests.support.unanswered import PERIOD, SHORT, foreign, publish

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
# The clock is too slow to fire: periods end when the test says so.
BY_HAND = 0.001
ALONE = ("recorder", "guidance", "simulator")


def run_on(robot: RunningGraph, periods: int) -> None:
    """So many periods pass, and everybody hears of them."""
    robot.spin_until(lambda: not robot.simulator._outruns_recorder(), "the recorder to hear the first state")
    for _ in range(periods):
        robot.simulator._on_period()
        robot.settle()


def finish(robot: RunningGraph) -> None:
    """To the end of the run and of the log."""
    while robot.simulator.end_reason is None:
        run_on(robot, 1)
    robot.recorder.finish("completed")


def commanded(place: Path) -> set[int]:
    """Ticks with a command."""
    return {stamp // PERIOD for stamp, parts in LogReader(place).stamps() if JOINT_COMMAND.name in parts}


def acted(robot: RunningGraph) -> set[int]:
    """Ticks whose command acted, as the plant says."""
    codec = TickCodec(robot.composition.joint_names).plant_telemetry
    found = set()
    for _, parts in LogReader(robot.directory).stamps():
        stamp = int(codec.decode((parts[PLANT_TELEMETRY.name],))["command_stamp"][0])
        found |= {stamp // PERIOD} if stamp >= 0 else set()
    return found


def late_events(place: Path) -> list[list[int]]:
    """Ticks that were answered too late, as the log has it."""
    raws = [raw for name, _, raw in LogReader(place).messages() if name == CONTROLLER_EVENTS.name]
    lines = [json.loads(line) for raw in raws for line in raw[8:].rstrip(b"\0").decode().split("\n")]
    return [[stamp // PERIOD for stamp in line["stamps"]] for line in lines if line["kind"] == "late"]


def test_the_oldest_answer_that_acts_is_in_the_log_and_an_older_one_does_not_act(tmp_path: Path) -> None:
    """At 50 periods late a command acts and is in the tick of its state; at 51 it is refused, and the log says so."""
    with running_graph(tmp_path / "run", "duration=20.0", roles=ALONE, realtime=BY_HAND) as robot:
        robot.spin_until(lambda: robot.simulator.started, "the start")
        run_on(robot, MAX_LATE)
        publish(robot, foreign(robot, 0))
        robot.settle()
        run_on(robot, 2)
        publish(robot, foreign(robot, PERIOD))
        robot.settle()
        assert robot.simulator.commands.counts["stale"] == 1
        run_on(robot, 1)
        assert robot.recorder.written_until < 0, "tick 0 waits for what else belongs to its answer"
        finish(robot)
        assert robot.recorder.left_out.unrecorded == 0
    assert commanded(tmp_path / "run") >= acted(robot) == {0}
    assert replayed(tmp_path / "run", against="plant").equal


def test_what_is_no_tick_does_not_act_late(tmp_path: Path) -> None:
    """A stamp between two ticks has no place in the log, so it moves nothing."""
    with running_graph(tmp_path / "run", SHORT, roles=ALONE, realtime=BY_HAND) as robot:
        robot.spin_until(lambda: robot.simulator.started, "the start")
        run_on(robot, 3)
        publish(robot, foreign(robot, PERIOD + 17))
        run_on(robot, 2)
        assert robot.simulator.commands.counts["stale"] == 2
        finish(robot)
    assert acted(robot) == set()


def test_a_controller_far_behind_replays_equal(tmp_path: Path) -> None:
    """It answers 60 states one after another: the log has the newest and says that the oldest were answered."""
    with running_graph(tmp_path / "run", "duration=30.0", "controller={law: adaptive}", realtime=BY_HAND) as robot:
        controller = robot.nodes["controller"]
        assert isinstance(controller, ControllerNode)
        # As one that was not given the pace.
        controller._paced = False
        robot.spin_until(lambda: robot.simulator.commands.answered, "the first answer")
        run_on(robot, 1)
        robot.executor.remove_node(controller)
        run_on(robot, MAX_LATE + 10)
        robot.executor.add_node(controller)
        run_on(robot, 1)
        robot.spin_until(lambda: MAX_LATE * PERIOD in robot.simulator.commands.accepted.kept, "answers")
        finish(robot)
        assert robot.recorder.left_out.unrecorded == 0
    assert late_events(tmp_path / "run")
    assert commanded(tmp_path / "run") >= acted(robot)
    result = replayed(tmp_path / "run")
    assert result.equal, [(one.against, one.first) for one in result.outcomes]
    assert any("answered too late" in remark for remark in result.outcomes[0].remarks)


def test_a_slow_controller_answers_the_newest_state(tmp_path: Path) -> None:
    """Where states wait it skips to the newest one, so that its command is in time; the log shows what was skipped."""
    with running_graph(tmp_path / "run", SHORT, realtime=BY_HAND) as robot:
        robot.spin_until(lambda: robot.simulator.commands.answered, "the first answer")
        robot.executor.remove_node(robot.nodes["controller"])
        run_on(robot, 9)
        robot.executor.add_node(robot.nodes["controller"])
        finish(robot)
    first, *others = sorted(commanded(tmp_path / "run"))
    assert first == 0
    assert min(others) >= 8
    assert replayed(tmp_path / "run").equal
