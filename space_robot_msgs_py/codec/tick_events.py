"""What happens at a tick, in the messages of its stamp, and how a node says that nothing does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypeVar

import numpy as np

from space_robot_msgs_py.codec.statuses import decode_statuses, says_none
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.texts import decode_events
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import PlantSample, Telemetry
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, EVENTS, FAULTS, HOUSEKEEPING, PLANT_EVENTS, Topic

E = TypeVar("E", ControllerEvent, DiagnosticEvent)

# The topics of what happens, in the order of a tick: to the robot, to its commands, and what a supervisor finds.
DIAGNOSTICS: tuple[Topic, ...] = (FAULTS, PLANT_EVENTS, EVENTS)


def events_of(parts: Mapping[str, bytes], stamp: int) -> tuple[ControllerEvent, ...]:
    """The events of a tick; none where it has no message of them.

    Args:
        parts: canonical messages by topic name.
        stamp: of the tick [ns].

    Raises:
        LayoutError: the message is unreadable, or of another stamp.
    """
    return _decoded(CONTROLLER_EVENTS, parts, stamp, decode_events)


def encode_tick_housekeeping(codec: TelemetryCodec, stamp: int, summary: Telemetry | None) -> bytes:
    """The housekeeping of a tick as nodes exchange it: where none is due a message with the stamp alone says so."""
    return codec.encode(summary if summary is not None else Telemetry(stamp, (), (), np.empty(0)))[0]


def is_empty(topic: Topic, raw: bytes) -> bool:
    """Whether a message says that nothing of an optional topic belongs to its stamp; it goes into no log."""
    return len(raw) == _shortest() if topic is HOUSEKEEPING else says_none(raw)


@cache
def _shortest() -> int:
    return len(encode_tick_housekeeping(TelemetryCodec(HOUSEKEEPING), 0, None))


def diagnostics_of(parts: Mapping[str, bytes], stamp: int) -> tuple[DiagnosticEvent, ...]:
    """What happens at a tick: to the robot, to its commands, and what a supervisor found, in this order.

    Args:
        parts: canonical messages by topic name.
        stamp: of the tick [ns].

    Raises:
        LayoutError: a message is unreadable, or of another stamp.
    """
    return tuple(event for topic in DIAGNOSTICS for event in statuses_of(topic, parts, stamp))


def plant_events(sample: PlantSample) -> list[tuple[Topic, tuple[DiagnosticEvent, ...]]]:
    """The events of a sample by the topic they are published on, where there are any."""
    return [(topic, events) for topic, events in ((FAULTS, sample.faults), (PLANT_EVENTS, sample.events)) if events]


def statuses_of(topic: Topic, parts: Mapping[str, bytes], stamp: int) -> tuple[DiagnosticEvent, ...]:
    """The events of a tick on one topic of ``DIAGNOSTICS``; see ``diagnostics_of``."""
    return _decoded(topic, parts, stamp, decode_statuses)


def _decoded(
    topic: Topic, parts: Mapping[str, bytes], stamp: int, decode: Callable[[bytes], tuple[E, ...]]
) -> tuple[E, ...]:
    raw = parts.get(topic.name)
    events = () if raw is None else decode(raw)
    if events:
        check_stamp(topic, stamp, events[0].stamp)
    return events


def check_stamp(topic: Topic, stamp: int, found: int) -> None:
    """Refuse a message of another stamp than the tick's [ns].

    Raises:
        LayoutError: with both.
    """
    if found != stamp:
        raise LayoutError("parts of different stamps", key=topic.name, value=[stamp, found], accepted="one stamp")
