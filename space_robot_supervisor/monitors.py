"""One row of the table at work: persistence, hysteresis, inhibition."""

from __future__ import annotations

from math import inf
from typing import Literal

from space_robot_supervisor.rows import MonitorSpec

Edge = Literal["fires", "clears"]


class Monitor:
    """Looks at one value, tick by tick.

    Args:
        spec: its row.

    Attributes:
        spec: its row.
        seen: the value at the last look; None: there was none.
        calm: nearly always nothing is the matter: a tick at which the condition of a calm monitor does not hold changes
            nothing, and need not be looked at.
    """

    __slots__ = ("_count", "_fired", "_inhibited", "_left", "calm", "seen", "spec")

    def __init__(self, spec: MonitorSpec) -> None:
        self.spec = spec
        self.reset()

    def reset(self) -> None:
        """Forget everything, as at the start of a run."""
        self._inhibited = 0
        self._left: float = inf if self.spec.times is None else self.spec.times
        self.enter()

    def enter(self) -> None:
        """Begin to count again, as when another mode begins."""
        self._count, self._fired = 0, False
        self.calm = not self._inhibited
        self.seen: float | None = None

    def look(self, before: float | None, value: float | None) -> Edge | None:
        """Look at the value of a tick; whether it fires or clears now.

        It fires at the last of ``for`` periods in a row, and again only after that has ended, at most ``times``.

        Args:
            before: the value at the tick before; None: there was none.
            value: of this tick.
        """
        self.seen = value
        edge = self._look_closer(before)
        self.calm = not (self._fired or self._count or self._inhibited)
        return edge

    def _look_closer(self, before: float | None) -> Edge | None:
        if self._inhibited:
            self._inhibited -= 1
            return None
        if self._fired:
            if self._holds(before, self.spec.hysteresis):
                return None
            self._count, self._fired = 0, False
            return "clears"
        self._count = self._count + 1 if self._holds(before) else 0
        if self._count < self.spec.for_ or not self._left:
            return None
        self._fired, self._inhibited, self._left = True, self.spec.inhibit_after, self._left - 1
        return "fires"

    def _holds(self, before: float | None, slack: float = 0.0) -> bool:
        spec, value = self.spec, self.seen
        if value is None:
            return False
        if spec.unchanged:
            return value == before
        over = spec.above is not None and value > spec.above - slack
        return over or (spec.below is not None and value < spec.below + slack)
