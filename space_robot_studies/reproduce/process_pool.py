"""Processes that work side by side, stop together and never outlive their parent."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_studies.garbage_collection import collect_rarely

Result = TypeVar("Result")
Task = tuple[Callable[..., Result], tuple[Any, ...]]

# One process per run uses the cores; numeric libraries with threads of their own would fight over them.
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
ASK_EVERY = 0.2


class Workers:
    """A pool of worker processes that end with their parent and on its word.

    Args:
        count: how many; they start when there is work.
        stop: asked while waiting; a reason ends everything.
    """

    def __init__(self, count: int, stop: Callable[[], str | None]) -> None:
        context = get_context("spawn")
        # Nothing is ever sent: the workers hear that the other end was closed, by us or by our death.
        told, self._word = context.Pipe(duplex=False)
        self._stop = stop
        self._pool = ProcessPoolExecutor(count, context, _begin, (told,))

    def run(self, tasks: Sequence[Task[Result]], on_done: Callable[[int], None]) -> list[Result] | None:
        """Do the tasks; results in their order, or None if there was a reason to stop.

        Args:
            tasks: function and arguments, both picklable.
            on_done: told how many are done.

        Raises:
            SpaceRobotError: a worker process died.
        """
        try:
            with _single_threaded():
                futures = [self._pool.submit(function, *arguments) for function, arguments in tasks]
                finished = self._wait(futures, on_done)
            return [future.result() for future in futures] if finished else None
        except BrokenProcessPool:
            raise SpaceRobotError("a worker process died", key="--workers", accepted="fewer need less memory") from None

    def _wait(self, futures: Sequence[Future[Result]], on_done: Callable[[int], None]) -> bool:
        """Whether everything was done; if there was a reason to stop, nobody works any more on return."""
        pending: set[Future[Result]] = set(futures)
        while pending:
            _, pending = wait(pending, ASK_EVERY, FIRST_COMPLETED)
            if self._stop() is not None:
                self._word.close()
                self._pool.shutdown(cancel_futures=True)
                return False
            on_done(len(futures) - len(pending))
        return True

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *error: object) -> None:
        self._pool.shutdown(cancel_futures=True)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def stop_reason() -> str | None:
    """In a worker: why it should stop, or None."""
    return "interrupted" if _STOP.is_set() else None


# Of a worker process: set when its parent says so.
_STOP = threading.Event()


def _begin(told: Connection) -> None:
    # Ctrl-C reaches the whole group; the parent decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    collect_rarely()
    threading.Thread(target=_listen, args=(told,), daemon=True).start()


def _listen(told: Connection) -> None:
    told.poll(None)
    _STOP.set()
    if parent := parent_process():
        parent.join()
        os._exit(1)


@contextmanager
def _single_threaded() -> Iterator[None]:
    """Processes started in this block inherit one thread per numeric library."""
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name)
            else:
                os.environ[name] = value
