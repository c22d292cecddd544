"""std_msgs/String, events in one, rosgraph_msgs/Clock and the stamp in front of any stamped message."""

from __future__ import annotations

from collections.abc import Iterable

from space_robot_msgs_py.cdr import ENCAPSULATION, UINT32, pack_stamp, unpack_stamp
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.limits import EVENT_BYTES, STRING_BYTES, Limit


def peek_stamp(raw: bytes) -> int:
    """The stamp [ns] of a message that begins with a Header or a Time; nothing else is looked at."""
    return unpack_stamp(raw, 4)


def encode_string(text: str) -> bytes:
    """A std_msgs/String.

    Raises:
        LayoutError: the text holds a NUL, which ends a string in CDR.
    """
    if "\0" in text:
        raise LayoutError("text with a NUL cannot be sent", key="std_msgs/msg/String", value=text[:40])
    data = text.encode() + b"\0"
    return ENCAPSULATION + UINT32.pack(len(data)) + data


def decode_string(raw: bytes, limit: Limit = STRING_BYTES) -> str:
    """The text of a std_msgs/String.

    Args:
        raw: the message.
        limit: of its size, looked at before anything else.

    Raises:
        LayoutError: the bytes are not a string, or too many.
    """
    limit.check(len(raw), "std_msgs/msg/String", LayoutError)
    size = UINT32.unpack_from(raw, 4)[0] if len(raw) >= 8 else 0
    data = raw[8 : 8 + size]
    if raw[:2] != ENCAPSULATION[:2] or not size or len(data) != size or data[-1]:
        raise LayoutError("not a string", key="std_msgs/msg/String", value=f"{len(raw)} bytes")
    try:
        return data[:-1].decode()
    except UnicodeDecodeError:
        raise LayoutError("not UTF-8", key="std_msgs/msg/String", value=data[:40]) from None


def encode_events(events: Iterable[ControllerEvent]) -> bytes:
    """The events of one stamp as std_msgs/String, one per line."""
    return encode_string("\n".join(event.line for event in events))


def decode_events(raw: bytes) -> tuple[ControllerEvent, ...]:
    """The events in a std_msgs/String, at least one.

    Raises:
        LayoutError: the bytes are not a string, a line is no event, or their stamps differ.
    """
    events = tuple(ControllerEvent.of(line) for line in decode_string(raw, EVENT_BYTES).split("\n"))
    if len({event.stamp for event in events}) != 1:
        stamps = [event.stamp for event in events]
        raise LayoutError("events of different stamps", key="controller/events", value=stamps, accepted="one stamp")
    return events


def encode_clock(stamp: int) -> bytes:
    """A rosgraph_msgs/Clock from a time [ns]."""
    return ENCAPSULATION + pack_stamp(stamp)


def decode_clock(raw: bytes) -> int:
    """The time [ns] of a rosgraph_msgs/Clock."""
    return peek_stamp(raw)
