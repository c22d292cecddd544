from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("rclpy")

from space_robot_msgs_py.attitude import AttitudeAngles
from space_robot_msgs_py.codec.codecs import StateCodec
from space_robot_msgs_py.interfaces import RobotState
from space_robot_msgs_py.topics import ATTITUDE, TF, TF_STATIC
from space_robot_msgs_py.transforms import FrameTransforms
from space_robot_sim.nodes.transforms import TransformPublisher

pytestmark = pytest.mark.ros

URDF = """<robot name="r"><link name="base_link"/><link name="arm"/><link name="tool"/>
<joint name="hinge" type="continuous"><parent link="base_link"/><child link="arm"/></joint>
<joint name="end" type="fixed"><parent link="arm"/><child link="tool"/></joint></robot>"""
STATE = RobotState(
    100_000_000, np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5]), np.zeros(7), np.zeros(1), np.zeros(3)
)


class Publishers:
    """A node that keeps what is published, where tf2_msgs is installed and where it is not."""

    def __init__(self, *, installed, listeners=0):
        self.installed, self.heard = installed, []
        self.handle = SimpleNamespace(get_subscription_count=lambda: listeners)

    def publisher(self, topic):
        if topic in (TF, TF_STATIC) and not self.installed:
            raise ModuleNotFoundError("No module named 'tf2_msgs'")
        node = self

        class Publisher:
            handle = node.handle

            def publish(self, raw):
                node.heard.append((topic, raw))

        return Publisher()


def test_the_graph_hears_what_the_log_has():
    """Fixed frames are published once, moving ones at every state, with the bytes that are in the log."""
    node = Publishers(installed=True)
    transforms = TransformPublisher(node, URDF, ("hinge",))
    transforms.show(STATE)
    transforms.show(STATE)
    frames = FrameTransforms(URDF, ("hinge",))
    assert node.heard == [(TF_STATIC, frames.static), (TF, frames.of(STATE)), (TF, frames.of(STATE))]


def test_the_attitude_is_published_where_something_listens():
    """With a subscription the bytes that are in the log, without tf2_msgs too; without a subscription none."""
    node = Publishers(installed=False, listeners=1)
    TransformPublisher(node, URDF, ("hinge",)).show(STATE)
    base = StateCodec(("hinge",)).encode(STATE)[0]
    assert node.heard == [(ATTITUDE, AttitudeAngles(ATTITUDE).of(base))]


def test_without_tf2_msgs_nothing_is_published():
    """Where the message type is not installed the simulator goes on without transforms."""
    node = Publishers(installed=False)
    TransformPublisher(node, URDF, ("hinge",)).show(STATE)
    assert node.heard == []
