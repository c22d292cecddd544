"""What a run and the code that started it say to each other: progress, an early end, the time it took."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

ROLES = ("recorder", "guidance", "controller", "simulator")


@dataclass(frozen=True, slots=True)
class Hooks:
    """How a run talks to the code that started it.

    Attributes:
        on_tick: called with each finished tick.
        stop: asked often; a reason ends the run.
        warn: called before the run with each warning of the law.
    """

    on_tick: Callable[[int], None] = lambda tick: None
    stop: Callable[[], str | None] = lambda: None
    warn: Callable[[str], None] = lambda warning: None


class Stopwatch:
    """Times a flight from its first to its last tick, so that imports, compilation and discovery are not counted.

    Args:
        hooks: whom to pass everything on to.
    """

    def __init__(self, hooks: Hooks) -> None:
        self._on_tick = hooks.on_tick
        self._first: float | None = None
        self._last = 0.0
        self.hooks = Hooks(on_tick=self._reach, stop=hooks.stop)

    @property
    def seconds(self) -> float:
        """[s] between the first and the last tick seen."""
        return 0.0 if self._first is None else self._last - self._first

    def _reach(self, tick: int) -> None:
        if tick >= 0:
            self._last = perf_counter()
            if self._first is None:
                self._first = self._last
        self._on_tick(tick)
