"""Events of a controller during the run, as recorded in a log and repeated by a replay: one JSON line each."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from space_robot_msgs_py.errors import LayoutError

# Other nodes than before publish a topic of the run.
PUBLISHERS = "publishers"
# States were answered too late for the answers to act, or to be in the log.
LATE = "late"
# The law of the experiment had no answer: it is reset, and that of another mode answers.
LAW_FAILED = "law_failed"
# Of two controllers another one than before answers.
ACTING = "acting"
# What a recorder adds to the events of a controller.
RECORDED = frozenset((PUBLISHERS, LATE, ACTING))


@dataclass(frozen=True, slots=True)
class ControllerEvent:
    """Something that changes how a controller answers, from the state with this stamp on.

    Attributes:
        stamp: of the first command it acts on [ns].
        kind: ``parameters`` (content ``values``: what ``Tunable.tune`` was given), ``switch`` (``from``, ``to``),
            ``reset`` (of the law, because states passed unanswered), ``LAW_FAILED`` (``law``, ``reason``, and ``to``,
            the mode whose law answers), ``PUBLISHERS`` (``topic``, ``nodes``),
            ``LATE`` (``stamps`` of states that were answered, too late for the answers to be in the log) or ``ACTING``
            (``node`` that answers from here on): these three the recorder adds, and they change no answer at their
            stamp.
        content: plain data.
    """

    stamp: int
    kind: str
    content: Mapping[str, Any]

    @property
    def line(self) -> str:
        """The event as one line of JSON; equal events give equal lines."""
        return json.dumps({"stamp": self.stamp, "kind": self.kind, **self.content}, allow_nan=False)

    @classmethod
    def of(cls, line: str) -> ControllerEvent:
        """The event in a line.

        Raises:
            LayoutError: it is none.
        """
        try:
            content = json.loads(line)
            stamp, kind = content.pop("stamp"), content.pop("kind")
            # Python reads NaN and 1e999, which no JSON may have.
            json.dumps(content, allow_nan=False)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise LayoutError(f"not an event ({error})", key="controller/events", value=line[:80]) from None
        if type(stamp) is not int or stamp < 0 or not isinstance(kind, str):
            accepted = "an integer stamp [ns] and a kind"
            raise LayoutError("not an event", key="controller/events", value=line[:80], accepted=accepted)
        return cls(stamp, kind, content)


# Levels of diagnostic_msgs/DiagnosticStatus.
OK, WARN, ERROR = 0, 1, 2


@dataclass(frozen=True, slots=True)
class DiagnosticEvent:
    """Something that happens at a stamp, as one diagnostic_msgs/DiagnosticStatus can say it.

    Attributes:
        stamp: [ns].
        level: ``OK``, ``WARN`` or ``ERROR``.
        name: of what happens.
        message: what happens to it, such as ``begins``.
        hardware: the part of the robot; empty: the robot.
        values: (key, value) in order.
    """

    stamp: int
    level: int
    name: str
    message: str
    hardware: str = ""
    values: tuple[tuple[str, str], ...] = ()


def said(events: Iterable[DiagnosticEvent]) -> str:
    """Events as one line; equal events give equal lines."""
    return "; ".join(f"{one.name} {one.message} {dict(one.values)}" for one in events)
