"""Quality of service of every topic, without ROS: the graph, the log and the docs derive from it.

What a run consists of is RELIABLE, and its depth is 1000 because KEEP_LAST drops a burst beyond its depth silently: a
recorder that sleeps for a moment must lose nothing. Texts, references and what a controller says of itself are
TRANSIENT_LOCAL: a late joiner gets what it missed. Of what the simulator says of a state a late joiner needs the
newest, which is said again while it waits for an answer; of commands none needs an old one. Subscriptions ask for no
more than they need, so that a publisher with the default of ROS, which is VOLATILE, is heard.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

from space_robot_msgs_py.topics import Topic

INFINITE = {"sec": 9223372036, "nsec": 854775807}
VALUE_DEPTH = 1000
TOOL_DEPTH = 10
# What a simulator says of a state, and how many of them stay for late joiners in lock-step. Paced, none does.
OF_A_STATE = frozenset(("state", "plant_telemetry", "plant_event"))
LOCK_STEP_DEPTH = 10


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
    """What a publisher of a row of the table offers, and a log says of it."""
    if topic.latched:
        return Qos(1, "reliable", "transient_local")
    if topic.kind in ("tool", "set_point"):
        # Reliable, so that both kinds of subscriber match; volatile, because old times and diagnostics only confuse.
        return Qos(TOOL_DEPTH, "reliable", "volatile")
    return Qos(VALUE_DEPTH, "reliable", "transient_local")


def qos_of_states(topic: Topic, *, paced: bool, ahead: int = 0) -> Qos:
    """What a simulator offers of a topic.

    Args:
        topic: the row of the table.
        paced: states do not wait.
        ahead: so many states it may be ahead of a node that has to hear all of them.
    """
    if topic.kind not in OF_A_STATE:
        return qos_of(topic)
    if paced:
        return Qos(VALUE_DEPTH, "reliable", "volatile")
    return Qos(LOCK_STEP_DEPTH + ahead, "reliable", "transient_local")


def asked_of(topic: Topic) -> Qos:
    """What a subscription to a row of the table asks for."""
    offer = qos_of(topic)
    return replace(offer, durability="volatile") if topic.kind in OF_A_STATE | {"command"} else offer
