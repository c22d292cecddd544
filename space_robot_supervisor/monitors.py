"""One row of the table at work: persistence, hysteresis, inhibition."""

from __future__ import annotations

from typing import Literal

from space_robot_supervisor.table import MonitorSpec
from space_robot_supervisor.values import Snapshot, Value

Edge = Literal["fires", "clears"]


class Monitor:
    """Looks at one value, tick by tick.

    Args:
        spec: its row.
        value: reads the value.

    Attributes:
        spec: its row.
        seen: the value at the last look; None: there was none.
    """

    def __init__(self, spec: MonitorSpec, value: Value) -> None:
        self.spec, self._value = spec, value
        self.reset()

    def reset(self) -> None:
        """Forget everything, as at the start of a run."""
        self._inhibited = 0
        self.enter()

    def enter(self) -> None:
        """Begin to count again, as when another mode begins."""
        self._count, self._fired = 0, False
        self.seen: float | None = None

    def look(self, now: Snapshot) -> Edge | None:
        """Look at a tick; whether it fires or clears now.

        It fires at the last of ``for`` periods in a row, and again only after its condition has ended.
        """
        before, self.seen = self.seen, self._value(now)
        if self._inhibited:
            self._inhibited -= 1
            return None
        if self._fired:
            if self._holds(before, self.spec.hysteresis):
                return None
            self._count, self._fired = 0, False
            return "clears"
        self._count = self._count + 1 if self._holds(before) else 0
        if self._count < self.spec.for_:
            return None
        self._fired, self._inhibited = True, self.spec.inhibit_after
        return "fires"

    def _holds(self, before: float | None, slack: float = 0.0) -> bool:
        spec, value = self.spec, self.seen
        if value is None:
            return False
        if spec.unchanged:
            return value == before
        over = spec.above is not None and value > spec.above - slack
        return over or (spec.below is not None and value < spec.below + slack)
