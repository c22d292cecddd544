"""What a run and the code that started it say to each other: progress, an early end, the time it took."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

ROLES = ("recorder", "guidance", "controller", "simulator")
# Only in runs with a table of supervision, before the controller.
SUPERVISOR = "supervisor"
# Only in paced runs with two controllers: the second one.
STANDBY = "standby"
# Started by hand in place of the controller.
EFFORT_CONTROLLER = "effort_controller"


def roles_of(*, supervised: bool, failover: bool = False) -> tuple[str, ...]:
    """The roles of a run, in the order to bring them up: a node listens before it is spoken to."""
    watching, second = (SUPERVISOR,) if supervised else (), (STANDBY,) if failover else ()
    return ("recorder", "guidance", *watching, *second, "controller", "simulator")


@dataclass(frozen=True, slots=True)
class Hooks:
    """How a run talks to the code that started it.

    Attributes:
        on_tick: called with each finished tick.
        stop: asked often; a reason ends the run.
        warn: called before the run with each warning of the law.
        on_failure: called with the error that ended the run, with what caused it.
        on_end: called with the reason when the run is over, before its log is judged.
        debug: processes of the run show the traceback of a law that fails.
    """

    on_tick: Callable[[int], None] = lambda tick: None
    stop: Callable[[], str | None] = lambda: None
    warn: Callable[[str], None] = lambda warning: None
    on_failure: Callable[[BaseException], None] = lambda error: None
    on_end: Callable[[str], None] = lambda reason: None
    debug: bool = False


class Stopwatch:
    """Times a run from its first to its last tick, so that imports, compilation and discovery are not counted.

    Args:
        hooks: whom to pass everything on to.
    """

    def __init__(self, hooks: Hooks) -> None:
        self._on_tick = hooks.on_tick
        self._first: float | None = None
        self._last = 0.0
        self.hooks = replace(hooks, on_tick=self._reach)

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
