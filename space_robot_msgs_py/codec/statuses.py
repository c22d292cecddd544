"""Events as diagnostic_msgs/DiagnosticArray: rare messages of any length, through rosbags' serialiser."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.generic import parse
from space_robot_msgs_py.codec.schemas import typestore
from space_robot_msgs_py.codec.texts import peek_stamp
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.limits import EVENT_BYTES

TYPE = "diagnostic_msgs/msg/DiagnosticArray"


def encode_tick_statuses(stamp: int, events: Sequence[DiagnosticEvent]) -> bytes:
    """The events of a tick as nodes exchange them: where there is none a message says so, see ``says_none``."""
    if events:
        return encode_statuses(events)
    none = _none()
    return none[:4] + pack_stamp(stamp) + none[12:]


def encode_statuses(events: Sequence[DiagnosticEvent]) -> bytes:
    """The events of one stamp, at least one, as one canonical message.

    Raises:
        LayoutError: there is none, their stamps differ, or a text holds a NUL.
    """
    stamps = sorted({event.stamp for event in events})
    if len(stamps) != 1:
        raise LayoutError("not the events of one stamp", key=TYPE, value=stamps, accepted="one stamp")
    return _encode(stamps[0], events)


def says_none(raw: bytes) -> bool:
    """Whether a message has a stamp and no event; such messages go between nodes and into no log."""
    none = _none()
    # All but the stamp, in bytes 4 to 12.
    return len(raw) == len(none) and raw[:4] == none[:4] and raw[12:] == none[12:]


@cache
def _none() -> bytes:
    return _encode(0, ())


def _encode(stamp: int, events: Sequence[DiagnosticEvent]) -> bytes:
    types: Any = typestore().types
    time = types["builtin_interfaces/msg/Time"](*divmod(stamp, NANOSECONDS))
    statuses = [_status(types, event) for event in events]
    message = types[TYPE](types["std_msgs/msg/Header"](time, ""), statuses)
    return bytes(typestore().serialize_cdr(message, TYPE, little_endian=True))


def decode_statuses(raw: bytes) -> tuple[DiagnosticEvent, ...]:
    """The events in a message, at least one.

    Raises:
        LayoutError: the bytes are no such message, too many, or without an event.
    """
    EVENT_BYTES.check(len(raw), TYPE, LayoutError)
    message, stamp = parse(TYPE, raw), peek_stamp(raw)
    if not message.status:
        raise LayoutError("no event in it", key=TYPE)
    return tuple(
        DiagnosticEvent(
            stamp,
            int(one.level),
            one.name,
            one.message,
            one.hardware_id,
            tuple((pair.key, pair.value) for pair in one.values),
        )
        for one in message.status
    )


def _status(types: Any, event: DiagnosticEvent) -> Any:
    texts = (event.name, event.message, event.hardware, *(text for pair in event.values for text in pair))
    for text in texts:
        if "\0" in text:
            raise LayoutError("text with a NUL cannot be sent", key=TYPE, value=text[:40])
    pairs = [types["diagnostic_msgs/msg/KeyValue"](key, value) for key, value in event.values]
    return types["diagnostic_msgs/msg/DiagnosticStatus"](event.level, event.name, event.message, event.hardware, pairs)
