"""The robot's frames on the live graph, for tools."""

from __future__ import annotations

from space_robot_msgs_py.interfaces import RobotState
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import TF, TF_STATIC
from space_robot_msgs_py.transforms import FrameTransforms


class TransformPublisher:
    """Publishes `/tf` at every state and `/tf_static` once; does nothing where tf2_msgs is not installed.

    Args:
        node: in whose name.
        urdf: the robot.
        joint_names: its joints in model order.
    """

    def __init__(self, node: GraphNode, urdf: str, joint_names: tuple[str, ...]) -> None:
        self._frames = FrameTransforms(urdf, joint_names)
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
        """Publish the transforms at a state."""
        if self._publisher is not None and (message := self._frames.of(state)) is not None:
            self._publisher.publish(message)
