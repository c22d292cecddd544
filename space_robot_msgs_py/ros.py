"""The bridge to rclpy: QoS profiles, message classes, and messages from bytes."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from space_robot_msgs_py.qos import Qos
from space_robot_msgs_py.topics import Topic


def qos(offer: Qos) -> QoSProfile:
    """A quality of service as rclpy has it."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=offer.depth,
        reliability=ReliabilityPolicy[offer.reliability.upper()],
        durability=DurabilityPolicy[offer.durability.upper()],
    )


def message_class(topic: Topic) -> Any:
    """The Python class of the topic's messages."""
    package, _, name = topic.type.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def to_msg(topic: Topic, raw: bytes) -> Any:
    """The message in these bytes, as rclpy's object."""
    return deserialize_message(raw, message_class(topic))
