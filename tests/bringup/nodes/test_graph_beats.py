"""Heartbeats of nodes that were started one by one, on a clock that goes on when the test says so."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.modes.heartbeats import SILENT_SECONDS
from space_robot_bringup.nodes.graph_beats import GraphBeats
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import RunningGraph, running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
STEP = 0.5


class Beating:
    """Nodes of a run that look at each other."""

    def __init__(self, robot: RunningGraph) -> None:
        self.robot, self.now = robot, 0.0
        self.beats = {role: GraphBeats(node, role, lambda: self.now) for role, node in robot.nodes.items()}

    def go_on(self, seconds: float, silent: Collection[str] = ()) -> None:
        """So much time passes, in which these roles are stopped."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            for role in self.beats.keys() - set(silent):
                self.beats[role].look()
            self.robot.settle()


@pytest.mark.parametrize("role", ["guidance", "recorder", "simulator"])
def test_a_silent_node_ends_a_run_that_was_started_by_hand(tmp_path: Path, role: str) -> None:
    """Every node that hears of it ends with the same reason, which the log has; a controller may be silent."""
    with running_graph(tmp_path / "run", realtime=2e-3) as robot:
        robot.await_answer()
        beating = Beating(robot)
        beating.go_on(1.0)
        beating.go_on(2 * SILENT_SECONDS, silent=["controller"])
        assert all(node.end_reason is None for node in robot.nodes.values())
        beating.go_on(SILENT_SECONDS + 1.0, silent=[role])
        reason = f"{role}: its process was silent for 5 s"
        assert {node.end_reason for node in robot.nodes.values()} == {reason}
        robot.recorder.finish(reason)
    assert LogReader(tmp_path / "run").end_reason == reason


def test_nothing_is_missed_before_the_run_begins(tmp_path: Path) -> None:
    """A node compiles for a minute before it says anything again."""
    with running_graph(tmp_path / "run", roles=("guidance", "recorder", "controller"), realtime=2e-3) as robot:
        beating = Beating(robot)
        beating.go_on(1.0)
        beating.go_on(4 * SILENT_SECONDS, silent=["guidance"])
        assert all(node.end_reason is None for node in robot.nodes.values())


def test_a_node_beats_through_a_cleanup(tmp_path: Path) -> None:
    """What a managed node says of itself does not depend on its state."""
    with running_graph(tmp_path / "run", realtime=2e-3) as robot:
        robot.await_answer()
        beating, node = Beating(robot), robot.nodes["controller"]
        beating.go_on(1.0)
        node.must(node.trigger_deactivate)
        node.must(node.trigger_cleanup)
        beating.go_on(2 * SILENT_SECONDS)
        assert all(one.end_reason is None for one in robot.nodes.values())
