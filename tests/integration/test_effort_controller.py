"""The node that takes the place of the controller for who publishes efforts without a stamp."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy")
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray

from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_control.nodes.effort_controller import COMMANDS
from space_robot_msgs_py.log.reader import LogReader
from tests.support.commanded import efforts, end
from tests.support.harness import RunningGraph, running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
ROLES = ("recorder", "guidance", "effort_controller", "simulator")
SIZE = 4


def commander(robot: RunningGraph) -> tuple[Node, list[float]]:
    """A node with the default of ROS that answers what it sees with a list of numbers, one after the other."""
    node, said = Node("commander", context=robot.context), list[float]()
    publisher = node.create_publisher(Float64MultiArray, "effort_controller/commands", 10)
    robot.spin_until(publisher.get_subscription_count, "the effort controller")

    def say(tick: int) -> None:
        said.append(1e-3 * (tick + 1))
        publisher.publish(Float64MultiArray(data=[said[-1]] * SIZE))

    robot.simulator.on_tick = say
    say(0)
    return node, said


def test_in_lock_step_every_message_answers_one_state(tmp_path: Path) -> None:
    """One for each state: each acts once, in order, and the plant replays."""
    with running_graph(tmp_path / "run", "duration=5.0", roles=ROLES) as robot:
        node, said = commander(robot)
        end(robot)
        assert robot.simulator.end_reason == "completed"
        node.destroy_node()
    assert efforts(tmp_path / "run") == said
    assert not LogReader(tmp_path / "run").arrays().wrench.any()
    assert replay(tmp_path / "run", ReplayOptions(against="plant")).equal


def test_paced_the_newest_counts(tmp_path: Path) -> None:
    """One message answers every state from then on, as of an effort controller; what does not fit is refused."""
    with running_graph(tmp_path / "run", "duration=5.0", roles=ROLES, realtime=5.0) as robot:
        node = Node("commander", context=robot.context)
        publisher = node.create_publisher(Float64MultiArray, "effort_controller/commands", 10)
        robot.spin_until(publisher.get_subscription_count, "the effort controller")
        adapter = robot.nodes["effort_controller"]
        for bad in ([1.0] * (SIZE + 1), [float("nan")] * SIZE):
            publisher.publish(Float64MultiArray(data=bad))
        robot.spin_until(lambda: adapter.refusals[COMMANDS.name] == 2, "both refusals")
        publisher.publish(Float64MultiArray(data=[0.002] * SIZE))
        end(robot)
        node.destroy_node()
    found = efforts(tmp_path / "run")
    assert found
    assert set(found) == {0.002}
    assert np.isfinite(LogReader(tmp_path / "run").arrays().q).all()
