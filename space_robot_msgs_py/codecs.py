"""Every codec under one roof: values, texts and raw messages to and from canonical bytes."""

from space_robot_msgs_py.telemetry_codec import TelemetryCodec
from space_robot_msgs_py.text_codecs import (
    decode_clock,
    decode_events,
    decode_string,
    encode_clock,
    encode_events,
    encode_string,
    peek_stamp,
)
from space_robot_msgs_py.topic_bytes import LOGGED, TickCodec, TopicBytes
from space_robot_msgs_py.value_codecs import CommandCodec, ReferenceCodec, StateCodec

__all__ = [
    "LOGGED",
    "CommandCodec",
    "ReferenceCodec",
    "StateCodec",
    "TelemetryCodec",
    "TickCodec",
    "TopicBytes",
    "decode_clock",
    "decode_events",
    "decode_string",
    "encode_clock",
    "encode_events",
    "encode_string",
    "peek_stamp",
]
