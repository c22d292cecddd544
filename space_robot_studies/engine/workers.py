"""Which workers a study gets: local ones, or those of a Dask scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from typing import Any

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install
from space_robot_studies.engine.local_workers import LocalWorkers, cores
from space_robot_studies.engine.tasks import Stop, Workers

MAX_WORKERS = 1024
MIN_TIME_LIMIT, MAX_TIME_LIMIT = 0.1, 1e7


def check_workers(workers: int | None, scheduler: str | None, time_limit: float) -> None:
    """Refuse options that no workers can be had with.

    Raises:
        SpecError: a number out of range, or local workers and those of a scheduler.
    """
    if workers is not None and not 1 <= workers <= MAX_WORKERS:
        raise SpecError("not a number of workers", key="--workers", value=workers, accepted=f"1 to {MAX_WORKERS}")
    if workers is not None and scheduler is not None:
        raise SpecError("has workers of its own", key="--scheduler", value=scheduler, accepted="it or --workers")
    if not (isfinite(time_limit) and MIN_TIME_LIMIT <= time_limit <= MAX_TIME_LIMIT):
        accepted = f"{MIN_TIME_LIMIT:g} to {MAX_TIME_LIMIT:g} [s]"
        raise SpecError("not a usable limit", key="--time-limit", value=time_limit, accepted=accepted)


@contextmanager
def open_workers(
    workers: int | None,
    *,
    time_limit: float,
    scheduler: str | None = None,
    warm: tuple[Callable[..., object], tuple[Any, ...]] | None = None,
    stop: Stop = lambda: None,
) -> Iterator[Workers]:
    """Workers that are ready for tasks.

    Args:
        workers: number of local ones; None: one per core.
        time_limit: [s] of CPU time of a task; see ``WALL_FACTOR`` for the elapsed time.
        scheduler: address of a Dask scheduler, instead of local workers.
        warm: function and arguments, called once before local workers start.
        stop: asked meanwhile.

    Raises:
        SpecError: see ``check_workers``; Dask is not installed, or its scheduler is of no use.
    """
    check_workers(workers, scheduler, time_limit)
    if scheduler is None:
        with LocalWorkers(workers or cores(), time_limit, warm, stop) as local:
            yield local
        return
    try:
        # Only here: nothing else needs it, and it takes half a second to load.
        from space_robot_studies.engine.dask_workers import dask_workers
    except ImportError as error:
        accepted = install("cluster")
        raise SpecError(f"needs Dask ({error})", key="--scheduler", value=scheduler, accepted=accepted) from None
    with dask_workers(scheduler, time_limit) as remote:
        yield remote
