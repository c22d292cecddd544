"""Workers behind a Dask scheduler, on any number of machines; the only file that knows Dask."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from threading import Lock
from time import monotonic, sleep
from typing import Any

from distributed import Client, Future, wait
from distributed.comm.core import CommClosedError

from space_robot_bringup.compose.versions import versions
from space_robot_msgs_py.errors import SilenceError, SpecError
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.engine.tasks import Lost, Result, Stop, Task

CONNECT_SECONDS = 5
GATHER_SECONDS = 15
# Enough that no worker waits for its next task, few enough that bags do not pile up where they were made.
AHEAD = 3
POLL_SECONDS = 0.2
# Long enough for a large bag over a slow line.
FETCH_SECONDS = 10.0
# A worker that dies is restarted, or another machine joins; not much later than this.
PATIENCE_SECONDS = 60.0
LOGGERS = ("distributed", "distributed.client", "distributed.nanny", "tornado", "tornado.application", "asyncio")


@contextmanager
def dask_workers(address: str, time_limit: float) -> Iterator[DaskWorkers]:
    """The workers of a scheduler, if they give the same bits as this machine.

    Args:
        address: of the scheduler, e.g. ``tcp://10.0.0.1:8786``.
        time_limit: [s] of CPU time of a task.

    Raises:
        SpecError: nothing answers at the address, or its workers could not give the same bits.
    """
    # Its own remarks on dying workers and closed connections say nothing that is not said here.
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    key, accepted = "--scheduler", "the address of a running Dask scheduler, e.g. tcp://10.0.0.1:8786"
    try:
        client = Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SpecError(f"cannot be reached ({reason})", key=key, value=address, accepted=accepted) from None
    try:
        try:
            client.wait_for_workers(1, timeout=GATHER_SECONDS)
        except TimeoutError:
            raise SpecError("has no workers", key=key, value=address, accepted="dask worker ADDRESS") from None
        _check(client)
        yield DaskWorkers(client, time_limit)
    finally:
        with suppress(CommClosedError, OSError, TimeoutError):
            client.close()


class DaskWorkers:
    """See ``Workers``; every task runs in a worker process of its own beside the Dask worker, with the same limits.

    Args:
        client: of ready workers.
        time_limit: [s] of CPU time of a task.
    """

    def __init__(self, client: Client, time_limit: float) -> None:
        self._client, self._limit = client, time_limit

    def run(self, tasks: Iterable[Task[Result]], stop: Stop) -> Iterator[tuple[Task[Result], Result | Lost]]:
        """See ``Workers.run``; a task whose Dask worker dies is given to another one."""
        pending, submitted = iter(tasks), dict[Future[Any], Task[Result]]()
        seen = monotonic()
        try:
            while stop() is None:
                workers = len(self._client.nthreads())
                seen = monotonic() if workers else seen
                if monotonic() - seen > PATIENCE_SECONDS:
                    raise SilenceError("no worker is left", key="--scheduler", accepted="--resume when there are some")
                while len(submitted) < AHEAD * workers and (task := next(pending, None)) is not None:
                    submitted[self._client.submit(supervised, task, self._limit, pure=False)] = task
                if workers and not submitted:
                    return
                for future in _completed(submitted):
                    if (outcome := _outcome(future)) is not None:
                        yield submitted.pop(future), outcome
        except SilenceError:
            raise
        except (CancelledError, CommClosedError, OSError) as error:
            raise SilenceError(f"the scheduler is gone ({type(error).__name__})", key="--scheduler") from None


_LOCK = Lock()
_OWN: dict[float, LocalWorkers] = {}


def supervised(task: Task[Result], time_limit: float) -> Result | Lost:
    """In a Dask worker: do a task in a process beside it, which a law may kill or never leave."""
    with _LOCK:
        if time_limit not in _OWN:
            _OWN[time_limit] = LocalWorkers(1, time_limit)
        try:
            ((_, outcome),) = _OWN[time_limit].run([task], lambda: None)
        except SilenceError as error:
            del _OWN[time_limit]
            return Lost(f"lost: {type(error).__name__}", str(error))
    return outcome


def _check(client: Client) -> None:
    """Refuse workers whose bits could differ."""
    here = versions()
    for worker, count in client.nthreads().items():
        if count != 1:
            accepted = "dask worker ADDRESS --nthreads 1, as often as there are cores"
            raise SpecError("a worker has several threads", key=worker, value=count, accepted=accepted)
    try:
        found: dict[str, dict[str, str]] = client.run(versions)
    except Exception as error:
        # Whatever a worker without the packages makes of the request.
        what = f"cannot run this ({type(error).__name__}: {error})"
        raise SpecError(what, key="workers", accepted="some with the same space-robot installed") from None
    for worker, there in found.items():
        different = [f"{name} {there.get(name)}" for name in here if there.get(name) != here[name]]
        if different:
            wanted = ", ".join(f"{name} {here[name]}" for name in here)
            raise SpecError("a worker has other versions", key=worker, value=", ".join(different), accepted=wanted)


def _completed(submitted: dict[Future[Any], Any]) -> set[Future[Any]]:
    if not submitted:
        sleep(POLL_SECONDS)
        return set()
    try:
        return set(wait(list(submitted), timeout=POLL_SECONDS, return_when="FIRST_COMPLETED").done)
    except TimeoutError:
        return set()


def _outcome(future: Future[Any]) -> Any:
    """What became of a task: whatever it did itself is a result, so an error here is one of the machinery.

    None where the worker died with a finished result: the task is rescheduled.
    """
    try:
        error = future.exception(timeout=FETCH_SECONDS)
        if error is None:
            return future.result(timeout=FETCH_SECONDS)
    except TimeoutError:
        return None
    return Lost(f"lost: {type(error).__name__}", str(error))
