"""Every codec under one roof: values, texts and raw messages to and from canonical bytes."""

from space_robot_msgs_py.codec.accepted import Accepted, AcceptedCodec
from space_robot_msgs_py.codec.statuses import decode_statuses, encode_statuses, encode_tick_statuses, says_none
from space_robot_msgs_py.codec.supervision import SupervisionCodec
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.texts import (
    decode_clock,
    decode_events,
    decode_string,
    encode_clock,
    encode_events,
    encode_string,
    peek_stamp,
)
from space_robot_msgs_py.codec.tick_codec import TickCodec
from space_robot_msgs_py.codec.tick_events import encode_tick_housekeeping, is_empty, plant_events
from space_robot_msgs_py.codec.topic_bytes import LOGGED, TopicBytes
from space_robot_msgs_py.codec.values import CommandCodec, ReferenceCodec, StateCodec
from space_robot_msgs_py.codec.wheel_momentum import WheelMomentumCodec

__all__ = [
    "LOGGED",
    "Accepted",
    "AcceptedCodec",
    "CommandCodec",
    "ReferenceCodec",
    "StateCodec",
    "SupervisionCodec",
    "TelemetryCodec",
    "TickCodec",
    "TopicBytes",
    "WheelMomentumCodec",
    "decode_clock",
    "decode_events",
    "decode_statuses",
    "decode_string",
    "encode_clock",
    "encode_events",
    "encode_statuses",
    "encode_string",
    "encode_tick_housekeeping",
    "encode_tick_statuses",
    "is_empty",
    "peek_stamp",
    "plant_events",
    "says_none",
]
