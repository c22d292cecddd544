"""What is seen at a tick, and from when to when it is judged: from a time or an event on, to another."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

from space_robot_bringup.experiment.expectations import Moment, Temporal
from space_robot_bringup.judge.wording import unopened
from space_robot_msgs_py.interfaces import NANOSECONDS


@dataclass(frozen=True, slots=True)
class Finding:
    """What a run shows.

    Attributes:
        passed: it is as wanted; None: the run does not tell.
        reason: why, in words, with time and tick.
        measured: the number it depends on, where there is one.
    """

    passed: bool | None
    reason: str
    measured: float | None = None


@dataclass(frozen=True, slots=True)
class Now:
    """What is seen at one tick.

    Attributes:
        stamp: [ns].
        holds: the condition.
        value: the number that the condition is about; None: there is none.
        events: what happens, see ``happenings.names_of``.
        said: the value in words.
    """

    stamp: int
    holds: bool
    value: float | None
    events: Set[str]
    said: str


@dataclass(frozen=True, slots=True)
class Clock:
    """How stamps are said.

    Attributes:
        period: control period [ns].
        last: stamp of the last tick that the experiment asks for [ns].
    """

    period: int
    last: int

    def at(self, stamp: int) -> str:
        """A stamp in words."""
        return f"at {stamp / NANOSECONDS:g} s (tick {stamp // self.period})"


class Window:
    """From when to when something is judged: opened by a time or an event, closed by another.

    Args:
        spec: what is expected.

    Attributes:
        open: it is judged now.
        opened: it has been.
    """

    def __init__(self, spec: Temporal) -> None:
        self._spec, self._after, self._until = spec, _moment(spec.after), _moment(spec.until)
        self.open = self.opened = False

    def opens(self, now: Now) -> bool:
        """Take a tick; whether the window begins here, or begins again."""
        if isinstance(self._until, int) and now.stamp >= self._until:
            self.open = False
            return False
        if self._until in now.events:
            self.open = False
        if isinstance(self._after, str):
            begins = self._after in now.events
        else:
            begins = not self.opened and now.stamp >= (self._after or 0)
        if begins:
            self.open = self.opened = True
        return begins

    @property
    def ends_with_run(self) -> bool:
        """Nothing else has closed it."""
        return self.open and not isinstance(self._until, int)

    def unseen(self, clock: Clock, last: int) -> str:
        """Why it was not seen to its end, if the run ended at a stamp [ns]; nothing where it was."""
        if not self.opened:
            return unopened(self._spec)
        end = self._until if isinstance(self._until, int) else clock.last if self.open or not self._until else last
        return "" if last >= end else f"the run ended at {last / NANOSECONDS:g} s, before {end / NANOSECONDS:g} s"


def nanoseconds(seconds: float | None) -> int:
    """A time [s] as a stamp [ns]; None: 0."""
    return 0 if seconds is None else round(seconds * NANOSECONDS)


def _moment(moment: Moment | None) -> int | str | None:
    """A time as a stamp [ns]."""
    return moment if moment is None or isinstance(moment, str) else nanoseconds(moment)
