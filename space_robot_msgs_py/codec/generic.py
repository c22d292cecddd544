"""Canonical bytes of any standard message, through rosbags' Python serialiser: slow, and independent of layouts."""

from __future__ import annotations

import struct
from typing import Any

from space_robot_msgs_py.codec.cdr import MAX_TRAILING, check_encapsulation
from space_robot_msgs_py.codec.schemas import typestore
from space_robot_msgs_py.errors import LayoutError


def canonical_message(ros_type: str, raw: bytes) -> bytes:
    """The same message as little-endian CDR with zero padding and nothing behind it.

    Args:
        ros_type: ``package/msg/Name``.
        raw: CDR of either byte order, with whatever its writer left in the padding.

    Raises:
        LayoutError: the bytes are not such a message.
    """
    return serialise(ros_type, parse(ros_type, raw))


def serialise(ros_type: str, message: Any) -> bytes:
    """The canonical bytes of what ``parse`` gave."""
    store: Any = typestore()
    return bytes(store.serialize_cdr(message, ros_type, little_endian=True))


def parse(ros_type: str, raw: bytes) -> Any:
    """The message as rosbags' dataclass.

    The deserialiser proper is called, which says where it stopped: rosbags' own check refuses what Fast DDS appends.

    Raises:
        LayoutError: the bytes are not such a message.
    """
    check_encapsulation(raw, ros_type)
    store: Any = typestore()
    definition = store.get_msgdef(ros_type)
    try:
        deserialise = {
            b"\x00\x00": definition.deserialize_cdr_be,
            b"\x00\x01": definition.deserialize_cdr_le,
        }[bytes(raw[:2])]
        message, end = deserialise(raw[4:], 0, definition.cls, store)
    except (KeyError, IndexError, ValueError, AssertionError, struct.error, store_errors()) as error:
        raise LayoutError(f"not a {ros_type}: {error}", value=f"{len(raw)} bytes") from None
    if not 0 <= len(raw) - 4 - end <= MAX_TRAILING:
        raise LayoutError(f"not a {ros_type}", value=f"{len(raw)} bytes", accepted=f"{end + 4} bytes")
    return message


def store_errors() -> type[Exception]:
    """What rosbags raises for bytes it cannot read."""
    from rosbags.serde import SerdeError

    return SerdeError
