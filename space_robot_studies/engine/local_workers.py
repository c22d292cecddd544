"""Workers of this machine: one task at a time each, ended at the time limit, replaced when they die."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import wait
from time import monotonic
from typing import Any

from space_robot_studies.engine.spawner import Spawner, WorkerProcess
from space_robot_studies.engine.tasks import WALL_FACTOR, Lost, Result, Stop, Task, over_cpu, over_wall

POLL_SECONDS = 0.2


@dataclass(frozen=True, slots=True)
class Busy:
    """A worker and its task.

    Attributes:
        worker: the process.
        task: what it does.
        wall: [s] of the monotonic clock when it began.
        cpu: [s] of CPU time the process had used then.
    """

    worker: WorkerProcess
    task: Task[Any]
    wall: float
    cpu: float

    def overdue(self, limit: float) -> Lost | None:
        """What becomes of the task if it has used up its time; the elapsed time counts where /proc is not there."""
        limit *= self.task.runs
        if cpu_time(self.worker.pid) - self.cpu > limit:
            return over_cpu(limit)
        return over_wall(limit) if monotonic() - self.wall > WALL_FACTOR * limit else None


class LocalWorkers:
    """Worker processes that end with this one; use it as a context manager.

    Args:
        count: how many; each is started when there is work for it.
        time_limit: [s] of CPU time of a task, and ``WALL_FACTOR`` times as much elapsed time.
        warm: function and arguments that are called before the first worker starts, to load what all of them need.
        stop: asked meanwhile.
    """

    def __init__(
        self,
        count: int,
        time_limit: float,
        warm: tuple[Callable[..., object], tuple[Any, ...]] | None = None,
        stop: Stop = lambda: None,
    ) -> None:
        self._count, self._limit = count, time_limit
        self._spawner = Spawner()
        self._idle: list[WorkerProcess] = []
        try:
            if warm is not None:
                self._spawner.prepare(*warm, stop)
        except BaseException:
            self._spawner.close()
            raise

    def __enter__(self) -> LocalWorkers:
        return self

    def __exit__(self, *error: object) -> None:
        self._spawner.close()

    def run(self, tasks: Iterable[Task[Result]], stop: Stop) -> Iterator[tuple[Task[Result], Result | Lost]]:
        """See ``Workers.run``: a worker that dies, or is ended at the limit, costs the task it was doing."""
        pending, busy = iter(tasks), dict[Any, Busy]()
        ended: list[tuple[Task[Result], Result | Lost]] = []
        try:
            while stop() is None:
                # First of all there is work for those that have none.
                while len(busy) < self._count and (task := next(pending, None)) is not None:
                    began = self._begin(task)
                    busy[began.worker.connection] = began
                yield from ended
                if not busy:
                    return
                ready = wait(list(busy), POLL_SECONDS)
                ended = [(one.task, self._finish(one)) for one in map(busy.pop, ready)]
                for connection, one in list(busy.items()):
                    if (lost := one.overdue(self._limit)) is not None:
                        self._spawner.kill(busy.pop(connection).worker)
                        ended.append((one.task, lost))
        finally:
            for one in busy.values():
                self._spawner.kill(one.worker)

    def _begin(self, task: Task[Any]) -> Busy:
        """Give a task to an idle worker, or to a new one."""
        while True:
            worker = self._idle.pop() if self._idle else self._spawner.start()
            cpu = cpu_time(worker.pid)
            # One that died while it was idle costs nothing.
            with suppress(OSError):
                worker.connection.send(task)
                return Busy(worker, task, monotonic(), cpu)

    def _finish(self, one: Busy) -> Any:
        try:
            answer = one.worker.connection.recv()
        except (EOFError, OSError):
            code = self._spawner.exit_code(one.worker)
            self._spawner.kill(one.worker)
            return Lost(_how_it_ended(code))
        self._idle.append(one.worker)
        return answer


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def cpu_time(pid: int) -> float:
    """CPU time a process has used [s]; 0 if that is not known."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as stream:
            fields = stream.read().rpartition(")")[2].split()
    except OSError:
        return 0.0
    # utime and stime are the 14th and 15th field; the name, which may hold blanks, is the second.
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _how_it_ended(code: int | None) -> str:
    if code is None:
        return "lost: the worker process went away"
    if code >= 0:
        return f"lost: the worker process exited with status {code}"
    with suppress(ValueError):
        return f"lost: the worker process was killed by {signal.Signals(-code).name}"
    return f"lost: the worker process was killed by signal {-code}"
