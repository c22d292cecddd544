"""A node of your own under pytest: the graph is in the test's process, in lock-step, and nothing sleeps.

pytest examples/test_rclpy_controller.py
"""

import pytest

import space_robot as sr

pytest.importorskip("rclpy")
from rclpy_controller import PdController


def test_the_controller_brings_the_robot_to_its_target(space_robot_graph) -> None:
    """After 100 s all is near the reference, and physics was kept."""
    graph = space_robot_graph("liu2023/fig08", {"duration": 120.0, "expect": {}}, without=["controller"])
    node = PdController(context=graph.context)
    graph.add_node(node)
    run = graph.finish(timeout=60.0)
    node.destroy_node()
    assert run.reason == "completed"
    sr.assert_tracking(run, attitude=0.02, joints=0.02, after=100.0)
    sr.assert_conserved(run)
