"""Which nodes publish the topics of a run, and when that changes: known from the graph, a message does not tell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from rclpy.topic_endpoint_info import TopicEndpointInfo

from space_robot_msgs_py.nodes.base import GraphNode, full_name
from space_robot_msgs_py.topics import Topic

# The first bytes of a publisher's id are those of its process.
PROCESS_BYTES = 12
# A publisher is discovered before the name of its node, which one that is no ROS node does not have.
UNNAMED = "_NODE_NAME_UNKNOWN_"
MAX_UNNAMED = 5


class Publishers:
    """Follows who publishes.

    Args:
        node: that asks the graph.
        topics: to follow.
        usual: topic to the name of the node that is meant to publish it; the first of another name is a change.
    """

    def __init__(self, node: GraphNode, topics: Iterable[Topic], usual: Mapping[Topic, str] | None = None) -> None:
        self._node, self._usual = node, usual or {}
        # Nodes with their processes: one that is configured anew has two publishers for a moment.
        self._known = {topic: frozenset[tuple[str, bytes]]() for topic in topics}
        self._unnamed: Counter[Topic] = Counter()

    def changes(self) -> list[tuple[Topic, list[str]]]:
        """Topics whose publishers changed since the last call, with the nodes that publish them now.

        The first publisher of a topic, where it is the usual one, and one that is gone, are no change; a second one is,
        and another one. Asks the graph once for every topic, about 0.1 ms each.
        """
        found = []
        for topic, before in self._known.items():
            endpoints = self._node.get_publishers_info_by_topic(topic.name)
            now = frozenset((full_name(one), bytes(one.endpoint_gid[:PROCESS_BYTES])) for one in endpoints)
            # One that is gone may be replaced later: it is remembered until then.
            if not now or now == before or self._waits_for_names(topic, endpoints):
                continue
            self._known[topic] = now
            names = sorted(name for name, _ in now)
            if len(now) > 1 or (not now <= before if before else self._is_unusual(topic, names)):
                found.append((topic, names))
        return found

    def _is_unusual(self, topic: Topic, names: Iterable[str]) -> bool:
        usual = self._usual.get(topic)
        return usual is not None and any(name.rpartition("/")[2] != usual for name in names)

    def _waits_for_names(self, topic: Topic, endpoints: Iterable[TopicEndpointInfo]) -> bool:
        if all(one.node_name != UNNAMED for one in endpoints):
            return False
        self._unnamed[topic] += 1
        return self._unnamed[topic] < MAX_UNNAMED
