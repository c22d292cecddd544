"""The attitude in degrees on the live graph, for tools, where one listens."""

from __future__ import annotations

from space_robot_msgs_py.attitude import AttitudeAngles
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic


class AttitudePublisher:
    """Publishes roll, pitch and yaw; without a subscription it costs a look at their number.

    Args:
        node: in whose name.
        topic: ``base/attitude_rpy_deg`` or ``reference/attitude_rpy_deg``.
    """

    def __init__(self, node: GraphNode, topic: Topic) -> None:
        self._angles = AttitudeAngles(topic)
        self._publisher = node.publisher(topic)

    def show(self, stamp: int, q: Vector) -> None:
        """Publish the attitude of a configuration (7+n,) at a stamp [ns]."""
        if self._publisher.handle.get_subscription_count() == 0:
            return
        if (message := self._angles.at(stamp, q[3:7])) is not None:
            self._publisher.publish(message)
