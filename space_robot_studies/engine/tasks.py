"""What workers do, and what becomes of it: a result, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from space_robot_msgs_py.errors import SpaceRobotError

Result = TypeVar("Result")
Stop = Callable[[], str | None]

# Seconds of CPU time that a run may take: more than a hundred times what the longest shipped run takes.
TIME_LIMIT = 300.0
# The elapsed time may be this many times the limit: cores are shared, but a run that waits for ever has to end.
WALL_FACTOR = 10.0


@dataclass(frozen=True, slots=True)
class Task(Generic[Result]):
    """A call that a worker process makes.

    Attributes:
        key: names its row in a journal.
        function: of a module; workers import it.
        arguments: picklable.
        runs: how many runs it does; each may take the time limit.
    """

    key: int | str
    function: Callable[..., Result]
    arguments: tuple[Any, ...]
    runs: int = 1


@dataclass(frozen=True, slots=True)
class Lost:
    """A task without a result: its worker process ended, it hit the time limit, or it raised.

    Attributes:
        reason: the same on every machine.
        detail: a traceback, or what is known beyond the reason.
        error: what it raised, where that is an error of this project, such as a full disk.
        time_limit: [s] that ended it; None: something else did.
    """

    reason: str
    detail: str = ""
    error: SpaceRobotError | None = None
    time_limit: float | None = None


class Workers(Protocol):
    """Processes that do tasks: on this machine, or behind a Dask scheduler."""

    def run(self, tasks: Iterable[Task[Result]], stop: Stop) -> Iterator[tuple[Task[Result], Result | Lost]]:
        """Each task with what became of it, in the order in which they end.

        Args:
            tasks: taken one by one, a few ahead of what is done.
            stop: asked often; a reason ends the iteration, and what is pending is given up.

        Raises:
            SilenceError: there are no workers any more.
        """
        ...


def over_cpu(limit: float) -> Lost:
    """What becomes of a task that used more CPU time than it may."""
    return Lost(f"timeout: more than {limit:g} s of CPU time", time_limit=limit)


def over_wall(limit: float) -> Lost:
    """What becomes of a task that used little CPU time and did not end."""
    return Lost(f"timeout: more than {WALL_FACTOR * limit:g} s, most of them waiting", time_limit=limit)
