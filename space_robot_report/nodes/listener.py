"""Listens to a run without taking part in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rclpy.context import Context
from rclpy.node import Node

from space_robot_msgs_py.qos import Qos
from space_robot_msgs_py.ros import message_class, qos
from space_robot_msgs_py.topics import Topic

# BEST_EFFORT, so that no publisher ever waits for this node or sends twice: what is lost here is in the log. The depth
# is what a fast run says between two looks.
ASKED = Qos(1000, "best_effort", "volatile")


class Listener:
    """A node with a subscription to each topic, which is asked for what came; nothing is called back.

    Args:
        context: the rclpy context to live in.
        topics: to hear.
        name: of the node.
    """

    def __init__(self, context: Context, topics: Iterable[Topic], name: str = "viewer") -> None:
        self._node = Node(name, context=context, start_parameter_services=False, enable_rosout=False)
        self._readers = {
            topic: self._node.create_subscription(
                message_class(topic), topic.name, lambda message: None, qos(ASKED), raw=True
            )
            for topic in topics
        }

    def take(self) -> Iterator[tuple[Topic, bytes]]:
        """What came since the last look, topic by topic, each in its order."""
        for topic, reader in self._readers.items():
            for _ in range(ASKED.depth):
                found = reader.handle.take_message(reader.msg_type, True)
                if found is None:
                    break
                yield topic, found[0]

    def close(self) -> None:
        """Leave the graph."""
        self._node.destroy_node()
