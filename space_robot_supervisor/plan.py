"""What is planned: the schedule of a run, and sequences that are under way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_supervisor.table import SupervisionTable

SCHEDULE = "schedule"


@dataclass(frozen=True, slots=True)
class Step:
    """One thing to do.

    Attributes:
        command: as the ground gives it; empty: none.
        start: sequence to start; empty: none.
        by: ``schedule``, or the name of the sequence.
        last: nothing comes behind it.
    """

    command: str
    start: str
    by: str
    last: bool


class Plan:
    """Says which steps are due.

    Args:
        table: with schedule and sequences.
    """

    def __init__(self, table: SupervisionTable) -> None:
        self._schedule = [(_ns(step.at), step.do or "", step.start or "") for step in table.schedule]
        self._sequences = {
            name: [(_ns(step.after), step.do) for step in steps] for name, steps in table.sequences.items()
        }
        self.reset()

    def reset(self) -> None:
        """Back to the start of a run."""
        self._next = 0
        # By name: when it was started, and its next step.
        self._running: dict[str, tuple[int, int]] = {}

    @property
    def idle(self) -> bool:
        """Nothing is planned any more."""
        return not self._running and self._next >= len(self._schedule)

    @property
    def running(self) -> tuple[str, ...]:
        """Names of the sequences under way, the oldest first."""
        return tuple(self._running)

    def begun(self, name: str) -> int:
        """When a sequence under way was started [ns]."""
        return self._running[name][0]

    def start(self, name: str, stamp: int) -> None:
        """Start a sequence, or start it again."""
        self._running.pop(name, None)
        self._running[name] = stamp, 0

    def stop(self, name: str) -> None:
        """End a sequence; one that is not under way stays so."""
        self._running.pop(name, None)

    def due(self, stamp: int) -> Iterator[Step]:
        """Every step whose time has come [ns], each once: those of the schedule first."""
        while self._next < len(self._schedule) and self._schedule[self._next][0] <= stamp:
            _, command, start = self._schedule[self._next]
            self._next += 1
            yield Step(command, start, SCHEDULE, last=False)
        for name in self.running:
            yield from self._due_of(name, stamp)

    def _due_of(self, name: str, stamp: int) -> Iterator[Step]:
        steps = self._sequences[name]
        # What a step of it does may end it.
        while name in self._running:
            begun, index = self._running[name]
            if index >= len(steps) or begun >= stamp or begun + steps[index][0] > stamp:
                return
            self._running[name] = begun, index + 1
            yield Step(steps[index][1], "", name, last=index + 1 == len(steps))


def _ns(seconds: float) -> int:
    return round(seconds * NANOSECONDS)
