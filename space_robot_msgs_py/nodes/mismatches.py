"""Which publishers and subscriptions of a topic do not match because of their quality of service, and why."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from space_robot_msgs_py.nodes.base import full_name


def mismatches(node: Node, handles: Iterable[Publisher | Subscription]) -> Iterator[str]:
    """A line for every endpoint of another node that is not matched with one of these; asks the graph for each.

    Args:
        node: whose they are.
        handles: its publishers and subscriptions.
    """
    for handle in handles:
        if isinstance(handle, Subscription):
            for one in node.get_publishers_info_by_topic(handle.topic_name):
                if why := _why(one.qos_profile, handle.qos_profile):
                    yield f"{full_name(one)} is not heard on {handle.topic_name}: offers {why}"
        else:
            for one in node.get_subscriptions_info_by_topic(handle.topic_name):
                if why := _why(handle.qos_profile, one.qos_profile):
                    yield f"{full_name(one)} does not hear {handle.topic_name}: offered {why}"


def _why(offered: QoSProfile, asked: QoSProfile) -> str:
    found = []
    if (offered.reliability, asked.reliability) == (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE):
        found.append("reliability BEST_EFFORT, asked RELIABLE")
    if (offered.durability, asked.durability) == (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL):
        found.append("durability VOLATILE, asked TRANSIENT_LOCAL")
    return "; ".join(found)
