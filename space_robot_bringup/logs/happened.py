"""What happened in a run, in one list: faults of the truth, the plant, what the supervisor and the controller did."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal, get_args

from space_robot_bringup.judge.happenings import entered
from space_robot_msgs_py.codec.tick_events import events_of, statuses_of
from space_robot_msgs_py.errors import LayoutError, LogError
from space_robot_msgs_py.events import ERROR, OK, WARN, ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import EVENTS, FAULTS, PLANT_EVENTS, Topic
from space_robot_supervisor.rows import Severity

Source = Literal["fault", "plant", "supervisor", "controller"]
SOURCES: tuple[Source, ...] = get_args(Source)
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
# A log may say of every tick that something happened.
MAX_EVENTS = 10_000
# In the order of a tick.
_TOPICS: Mapping[Topic, Source] = {FAULTS: "fault", PLANT_EVENTS: "plant", EVENTS: "supervisor"}
_LEVELS: Mapping[int, Severity] = {OK: "info", WARN: "medium", ERROR: "high"}


@dataclass(frozen=True, slots=True)
class Happened:
    """One event of a run.

    Attributes:
        stamp: of its tick [ns].
        source: ``fault`` (the truth), ``plant``, ``supervisor`` or ``controller``.
        severity: of a monitor its own; else that of the level: OK info, WARN medium, ERROR high.
        name: of the fault, the monitor, ``mode``, ``command safe``, ...
        message: what became of it, such as ``begins`` or ``fires``.
        detail: key to value of what else it says.
    """

    stamp: int
    source: Source
    severity: Severity
    name: str
    message: str
    detail: Mapping[str, str]

    @property
    def time(self) -> float:
        """[s]."""
        return self.stamp / NANOSECONDS

    @property
    def said(self) -> str:
        """The detail in words."""
        # Of a mode the message says what it was and is.
        left_out = ("from", "to") if self.mode else ()
        said = [f"{key} {_short(value)}" for key, value in self.detail.items() if value and key not in left_out]
        return ", ".join(said)

    @property
    def mode(self) -> str | None:
        """The mode that begins with it."""
        return self.detail.get("to") if self.source == "supervisor" and self.name == "mode" else None


class Witness:
    """Notes what happened at the ticks of a log while others read them.

    Args:
        rows: stamp [ns] and messages by topic name of each tick, see ``LogReader.rows``.

    Attributes:
        events: so far, in order; the first ``MAX_EVENTS``.
        left_out: how many more there were.
    """

    def __init__(self, rows: Iterable[Row]) -> None:
        self._rows = rows
        self.events: list[Happened] = []
        self.left_out = 0

    def rows(self) -> Iterator[Row]:
        """The same ticks; what of one cannot be read is left to those who read it."""
        for stamp, parts in self._rows:
            with suppress(LayoutError):
                self._note(list(happened_at(parts, stamp)))
            yield stamp, parts

    def _note(self, events: Sequence[Happened]) -> None:
        room = MAX_EVENTS - len(self.events)
        self.events += events[:room]
        self.left_out += len(events[room:])


def events_of_log(reader: LogReader) -> tuple[Witness, str]:
    """What happened in a log as far as it can be read, at incomplete ticks too, and why no further, or nothing."""
    witness = Witness(reader.stamps())
    try:
        deque(witness.rows(), maxlen=0)
    except LogError as error:
        return witness, str(error)
    return witness, ""


def happened_at(parts: Mapping[str, bytes], stamp: int) -> Iterator[Happened]:
    """The events of a tick, in order.

    Args:
        parts: canonical messages by topic name.
        stamp: of the tick [ns].

    Raises:
        LayoutError: a message is unreadable, or of another stamp.
    """
    for topic, source in _TOPICS.items():
        for event in statuses_of(topic, parts, stamp):
            yield _of_status(event, source)
    for change in events_of(parts, stamp):
        yield _of_change(change)


def _of_status(event: DiagnosticEvent, source: Source) -> Happened:
    values = dict(event.values)
    said = values.pop("severity", "")
    severity = next((one for one in SEVERITIES if one == said), _LEVELS.get(event.level, "high"))
    if event.level == OK:
        severity = "info"
    name = event.name
    if source == "supervisor" and entered(event) is None and event.name in values:
        # `command safe`, `sequence stow`: as expectations call them.
        name = f"{event.name} {values.pop(event.name)}"
    return Happened(event.stamp, source, severity, name, event.message, values)


def _of_change(change: ControllerEvent) -> Happened:
    detail = {key: value if isinstance(value, str) else json.dumps(value) for key, value in change.content.items()}
    return Happened(change.stamp, "controller", "info", change.kind, "", detail)


def _short(value: str) -> str:
    """A number in as many digits as are read; a whole one, and any other text, as it is."""
    try:
        return value if "." not in value and "e" not in value else f"{float(value):.4g}"
    except ValueError:
        return value
