"""The bridge to rclpy: QoS profiles, message classes, and lossless conversion between values and standard messages."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, TypeVar

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message

from space_robot_msgs_py.codec.generic import canonical_message
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.values import PartsCodec
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Telemetry
from space_robot_msgs_py.qos import Qos
from space_robot_msgs_py.topics import Topic

V = TypeVar("V")


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


def from_msg(topic: Topic, msg: Any) -> bytes:
    """The canonical bytes of a message for this topic.

    Raises:
        LayoutError: the message is of another type.
    """
    if not isinstance(msg, message_class(topic)):
        raise LayoutError("wrong type", key=topic.name, value=type(msg).__name__, accepted=topic.type)
    return canonical_message(topic.type, serialize_message(msg))


def to_bytes(msg: Any) -> bytes:
    """The canonical bytes of any standard message; Fast DDS alone leaves the padding undefined."""
    package = type(msg).__module__.partition(".")[0]
    return canonical_message(f"{package}/msg/{type(msg).__name__}", serialize_message(msg))


def value_to_msgs(codec: PartsCodec[V], value: V) -> tuple[Any, ...]:
    """A state, reference or command as standard messages, in the order of ``codec.topics``."""
    return tuple(to_msg(topic, raw) for topic, raw in zip(codec.topics, codec.encode(value), strict=True))


def value_from_msgs(codec: PartsCodec[V], msgs: Sequence[Any]) -> V:
    """The value in standard messages, which are in the order of ``codec.topics``; inverse of ``value_to_msgs``."""
    return codec.decode([from_msg(topic, msg) for topic, msg in zip(codec.topics, msgs, strict=True)])


def telemetry_to_msg(codec: TelemetryCodec, telemetry: Telemetry) -> Any:
    """Telemetry as std_msgs/Float64MultiArray."""
    return to_msg(codec.topics[0], codec.encode(telemetry)[0])


def telemetry_from_msg(codec: TelemetryCodec, msg: Any) -> Telemetry:
    """The telemetry in a std_msgs/Float64MultiArray."""
    return codec.decode([from_msg(codec.topics[0], msg)])
