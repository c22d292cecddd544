"""Modes and faults of a run as spans of time, from the events that begin and end them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.logs.happened import Happened
from space_robot_sim.faults.plan import BEGINS, ENDS


@dataclass(frozen=True, slots=True)
class Span:
    """A time in which something is so.

    Attributes:
        name: of the mode or the fault.
        begin: [s].
        end: [s].
    """

    name: str
    begin: float
    end: float

    @property
    def said(self) -> str:
        """In words."""
        return f"{self.name} {self.begin:g} to {self.end:g} s"


@dataclass(frozen=True, slots=True)
class Spans:
    """What a run was in.

    Attributes:
        modes: one after the other; none without supervision.
        faults: in the order of their onsets.
    """

    modes: tuple[Span, ...] = ()
    faults: tuple[Span, ...] = ()

    @classmethod
    def of(cls, events: Sequence[Happened], experiment: Experiment | None, last: float) -> Spans:
        """The spans of a run.

        Args:
            events: of the run, in order.
            experiment: that was run; None: it is not known.
            last: time of the last tick [s].
        """
        table = experiment.supervision if experiment is not None else None
        modes = mode_spans(events, table.start, last) if table is not None else []
        return cls(tuple(modes), tuple(fault_spans(events, last)))

    @property
    def said(self) -> tuple[str, ...]:
        """A line each for the modes and the faults, where there are any."""
        found = (("modes", self.modes), ("faults", self.faults))
        return tuple(f"{what}: {', '.join(span.said for span in spans)}" for what, spans in found if spans)

    def at(self, time: float) -> tuple[str, tuple[str, ...]]:
        """The mode at a time [s], or nothing, and the faults that act."""
        mode = next((span.name for span in reversed(self.modes) if span.begin <= time), "")
        return mode, tuple(span.name for span in self.faults if span.begin <= time < span.end)


NO_SPANS = Spans()


def mode_spans(events: Iterable[Happened], start: str, last: float) -> list[Span]:
    """The modes of a run, one after the other; a mode that is left at the tick it is entered has no length.

    Args:
        events: of the run.
        start: the first mode.
        last: time of the last tick [s].
    """
    changes = [(0.0, start), *((event.time, event.mode) for event in events if event.mode)]
    ends = [*(begin for begin, _ in changes[1:]), last]
    return [Span(name, begin, end) for (begin, name), end in zip(changes, ends, strict=True)]


def fault_spans(events: Sequence[Happened], last: float) -> list[Span]:
    """The faults of a run, in the order of their onsets; one that does not end lasts to the end of the run [s]."""
    begun: dict[str, float] = {}
    found: list[Span] = []
    for event in (one for one in events if one.source == "fault"):
        if event.message == BEGINS:
            begun.setdefault(event.name, event.time)
        elif event.message == ENDS and event.name in begun:
            found.append(Span(event.name, begun.pop(event.name), event.time))
    found += [Span(name, begin, last) for name, begin in begun.items()]
    return sorted(found, key=lambda span: span.begin)
