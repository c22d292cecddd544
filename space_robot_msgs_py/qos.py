"""Quality of service of every topic, without ROS: the graph, the log and the docs derive from it.

Values, texts and descriptions are RELIABLE and TRANSIENT_LOCAL: a late joiner gets what it missed and thereby starts a
lock-step run, where VOLATILE would wait for ever. The depth is 1000 because KEEP_LAST drops a burst beyond its depth
silently, and a recorder that starts late, or sleeps for a moment, must lose nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from space_robot_msgs_py.topics import Topic

INFINITE = {"sec": 9223372036, "nsec": 854775807}
VALUE_DEPTH = 1000
TOOL_DEPTH = 10


@dataclass(frozen=True, slots=True)
class Qos:
    """What a publisher of a topic offers; history is KEEP_LAST everywhere."""

    depth: int
    reliability: Literal["reliable", "best_effort"]
    durability: Literal["transient_local", "volatile"]

    def as_rosbag2(self) -> dict[str, Any]:
        """One entry of ``offered_qos_profiles`` as rosbag2 of Jazzy (metadata version 9) writes it."""
        return {
            "history": "keep_last",
            "depth": self.depth,
            "reliability": self.reliability,
            "durability": self.durability,
            "deadline": dict(INFINITE),
            "lifespan": dict(INFINITE),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(INFINITE),
            "avoid_ros_namespace_conventions": False,
        }


def qos_of(topic: Topic) -> Qos:
    """The quality of service of a row of the table."""
    if topic.latched:
        return Qos(1, "reliable", "transient_local")
    if topic.kind == "tool":
        # Reliable, so that both kinds of subscriber match; volatile, because old times and diagnostics only confuse.
        return Qos(TOOL_DEPTH, "reliable", "volatile")
    return Qos(VALUE_DEPTH, "reliable", "transient_local")
