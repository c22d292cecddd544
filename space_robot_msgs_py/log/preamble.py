"""The head of a log: provenance, schemas and channels, the same bytes for the same run."""

from __future__ import annotations

from mcap.records import Attachment, Channel, Header, Schema

from space_robot_msgs_py.codec.schemas import schema_text, type_hash
from space_robot_msgs_py.log.header import METADATA_NAME, LogHeader
from space_robot_msgs_py.log.mcap.records import MAGIC, metadata_bytes, record_bytes
from space_robot_msgs_py.qos import qos_of
from space_robot_msgs_py.topics import (
    ATTITUDE,
    HOUSEKEEPING,
    REFERENCE_ATTITUDE,
    SUPERVISOR_MODE,
    TABLE,
    WHEEL_MOMENTUM,
    Topic,
)
from space_robot_msgs_py.yaml_text import yaml_text

LIBRARY = "space_robot"
END_NAME = "end"
# What every log has comes first, and what came to the table later last, so that channels keep their numbers.
_LATER = (HOUSEKEEPING, SUPERVISOR_MODE, WHEEL_MOMENTUM, ATTITUDE, REFERENCE_ATTITUDE)
_FIRST = [one for one in TABLE if one.recorded and one not in _LATER]
RECORDED: tuple[Topic, ...] = (*sorted(_FIRST, key=lambda one: one.optional), *_LATER)
# A run without a topic has its channel, empty; of optional topics only those that its header names.
CHANNELS: dict[str, int] = {topic.name: number for number, topic in enumerate(RECORDED, start=1)}
ALWAYS = frozenset(topic.name for topic in RECORDED if not topic.optional)


def log_name(topic: Topic) -> str:
    """The name of a topic in a bag: absolute, as rosbag2 records and plays it."""
    return topic.name if topic.name.startswith("/") else f"/{topic.name}"


def channels_of(header: LogHeader) -> tuple[Topic, ...]:
    """The rows of the table that a log has channels of."""
    return tuple(topic for topic in RECORDED if not topic.optional or topic.name in header.topics)


def signature() -> bytes:
    """How a file of this project begins."""
    return MAGIC + record_bytes(Header("ros2", LIBRARY))


def preamble(header: LogHeader) -> bytes:
    """Everything in front of the first message."""
    parts = [
        signature(),
        metadata_bytes(METADATA_NAME, header.metadata()),
        *(_attachment(*one) for one in header.attachments()),
    ]
    channels = channels_of(header)
    types = list(dict.fromkeys(topic.type for topic in channels))
    for number, ros_type in enumerate(types, start=1):
        text = schema_text(ros_type).encode()
        parts.append(record_bytes(Schema(id=number, data=text, encoding="ros2msg", name=ros_type)))
    parts += [record_bytes(_channel(topic, types.index(topic.type) + 1)) for topic in channels]
    return b"".join(parts)


def _channel(topic: Topic, schema: int) -> Channel:
    metadata = {
        "offered_qos_profiles": yaml_text([qos_of(topic).as_rosbag2()]).strip(),
        "topic_type_hash": type_hash(topic.type),
    }
    return Channel(
        id=CHANNELS[topic.name],
        topic=log_name(topic),
        message_encoding="cdr",
        metadata=metadata,
        schema_id=schema,
    )


def _attachment(name: str, media_type: str, text: str) -> bytes:
    return record_bytes(Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=text.encode()))
