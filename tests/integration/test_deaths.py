"""A slice of the kill matrix (``python -m tests.chaos.kill``), and what its promises rest on."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")

from space_robot_bringup.nodes.patience import Patience
from space_robot_msgs_py.errors import SilenceError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import BASE_ODOM
from tests.chaos.kill import faults
from tests.chaos.victims import OVERRIDES, PARENT, Kill, kill_one
from tests.support.harness import running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
NO_HURRY = 60.0


def test_a_recorder_that_is_killed_ends_the_run_and_loses_one_tick_at_most(tmp_path: Path) -> None:
    """The others end, the log has the reason and lacks at most the tick being recorded; no print is news."""
    law = "controller.law=tests.support.laws:Talkative"
    assert faults(kill_one(Kill("recorder", tmp_path / "run", overrides=(*OVERRIDES, law))), None, NO_HURRY) == []


def test_nothing_outlives_a_parent_that_is_killed(tmp_path: Path) -> None:
    """A node whose parent was killed ends by itself; the recorder closes its log with that reason."""
    assert faults(kill_one(Kill(PARENT, tmp_path / "run", alone=True)), None, NO_HURRY) == []


def test_a_recorder_that_hardly_gets_to_run_closes_its_log(tmp_path: Path) -> None:
    """Also one that was being made when its parent was killed: no temporary file stays, and the log has the reason."""
    kill = Kill(PARENT, tmp_path / "run", alone=True, starved=True)
    assert faults(kill_one(kill), None, NO_HURRY) == []


def test_a_state_is_published_only_when_the_tick_before_is_logged(tmp_path: Path) -> None:
    """In processes of their own, state k comes when tick k - 1 is in the log: that is what a dead recorder can lose."""
    with running_graph(tmp_path / "run", "duration=10.0", services=True) as robot:
        seen: list[tuple[int, int]] = []
        robot.simulator.on_tick = lambda tick: seen.append(
            (tick, robot.recorder.written_until // robot.simulator.period)
        )
        robot.spin_until(lambda: robot.simulator.tick == 20, "half of the run")
        assert [tick for tick, _ in seen] == list(range(1, 21))
        assert all(written == tick - 1 for tick, written in seen)
        assert sum(1 for _ in LogReader(tmp_path / "run").ticks()) >= 19


@pytest.mark.parametrize("realtime", [None, 100.0])
def test_a_run_without_its_recorder_stands_and_says_why(tmp_path: Path, realtime: float | None) -> None:
    """A recorder that hears nothing more stops the simulator where its credit ends, in lock-step at the next tick."""
    with running_graph(tmp_path / "run", "duration=2500.0", services=True, realtime=realtime) as robot:
        robot.spin_until(lambda: robot.simulator.tick > 5, "the run to begin")
        robot.simulator._health._patience = 1.0
        robot.executor.remove_node(robot.recorder)
        last = robot.recorder.written_until // robot.simulator.period
        robot.spin_until(lambda: robot.simulator.failure is not None, "the simulator to miss its recorder")
        assert isinstance(robot.simulator.failure, SilenceError)
        assert "recorder/credit: the ticks before" in str(robot.simulator.failure)
        assert robot.simulator.tick - last <= (2 if realtime is None else 802)


def test_a_node_does_not_wait_for_ever(tmp_path: Path) -> None:
    """Without a simulator a node ends with a reason; with one, even paused, it waits."""
    with running_graph(tmp_path / "run", roles=("recorder", "guidance", "controller")) as robot:
        for node in robot.nodes.values():
            patience = Patience(node, BASE_ODOM, 0.2)
            robot.spin_until(lambda node=node, look=patience.look: look() or node.end_reason, "the node to give up")
        failure = robot.nodes["recorder"].failure
        assert isinstance(failure, SilenceError)
        assert "base/odom: nothing publishes it; the run is over or never began" in str(failure)
    with running_graph(tmp_path / "other") as robot:
        robot.simulator.pause(True)
        patience = Patience(robot.nodes["controller"], BASE_ODOM, 0.0)
        robot.spin_until(lambda: robot.nodes["controller"].publisher_count(BASE_ODOM), "the controller to hear it")
        for _ in range(20):
            robot.spin_for(0.02)
            patience.look()
        assert robot.nodes["controller"].end_reason is None
