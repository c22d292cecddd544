"""The robot's frames and its attitude on the live graph, for tools."""

from __future__ import annotations

from space_robot_msgs_py.interfaces import RobotState
from space_robot_msgs_py.nodes.attitude import AttitudePublisher
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import ATTITUDE, TF, TF_STATIC
from space_robot_msgs_py.transforms import FrameTransforms


class TransformPublisher:
    """Publishes `/tf` at every state and `/tf_static` once, where tf2_msgs is installed, and the attitude in degrees.

    Args:
        node: in whose name.
        urdf: the robot.
        joint_names: its joints in model order.
    """

    def __init__(self, node: GraphNode, urdf: str, joint_names: tuple[str, ...]) -> None:
        self._frames = FrameTransforms(urdf, joint_names)
        self._attitude = AttitudePublisher(node, ATTITUDE)
        try:
            self._publisher = node.publisher(TF)
        except ImportError:
            self._publisher = None
            return
        if self._frames.static is not None:
            # Kept: a publisher that is forgotten takes its latched message with it.
            self._static_publisher = node.publisher(TF_STATIC)
            self._static_publisher.publish(self._frames.static)

    def show(self, state: RobotState) -> None:
        """Publish the transforms and the attitude at a state."""
        self._attitude.show(state.stamp, state.q)
        if self._publisher is not None and (message := self._frames.of(state)) is not None:
            self._publisher.publish(message)
