"""Flies cases on the workers of a client, a few ahead of who is free."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass
from time import monotonic, sleep

from distributed import Client, Future, wait
from distributed.comm.core import CommClosedError

from space_robot_msgs_py.errors import SilenceError
from space_robot_studies.campaign.cases import Case
from space_robot_studies.campaign.run_case import Flown, Keep, fly_case

# Enough that nobody waits for the next case, few enough that bags do not pile up where they were made.
AHEAD = 3
POLL_SECONDS = 0.2
# Long enough for a large bag over a slow line.
FETCH_SECONDS = 10.0
# A worker that dies is restarted, or another machine joins; not much later than this.
PATIENCE_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class Lost:
    """A case of which nothing came back, as when it kills every worker it is given to.

    Attributes:
        reason: the same whoever flew it.
        detail: names of machines and files.
    """

    reason: str
    detail: str


def fly_cases(
    client: Client, cases: Iterator[Case], keep: Keep, stop: Callable[[], str | None]
) -> Iterator[tuple[Case, Flown | Lost]]:
    """Every case with what came of it, in the order in which they land; a worker that dies is flown for by another.

    Args:
        client: of ready workers.
        cases: to fly.
        keep: whose bags come back.
        stop: asked often; a reason ends it, what is in the air is left there.

    Yields:
        The case and what came of it.

    Raises:
        SilenceError: the scheduler is gone, or no worker has been there for a while.
    """
    air: dict[Future[Flown], Case] = {}
    seen = monotonic()
    try:
        while stop() is None:
            crew = len(client.nthreads())
            seen = monotonic() if crew else seen
            if monotonic() - seen > PATIENCE_SECONDS:
                raise SilenceError("no worker is left", key="--scheduler", accepted="--resume when there are some")
            for case in _next(cases, AHEAD * crew - len(air)):
                air[client.submit(fly_case, case.data, name_of(case), keep, pure=False)] = case
            if crew and not air:
                return
            for future in _landed(air):
                outcome = _result(future)
                if outcome is not None:
                    yield air.pop(future), outcome
    except SilenceError:
        raise
    except (CancelledError, CommClosedError, OSError) as error:
        raise SilenceError(f"the scheduler is gone ({type(error).__name__})", key="--scheduler") from None


def name_of(case: Case) -> str:
    """Name of the case's run directory."""
    return f"{case.index:06d}"


def _next(cases: Iterator[Case], count: int) -> Iterator[Case]:
    for _ in range(count):
        case = next(cases, None)
        if case is None:
            return
        yield case


def _landed(air: dict[Future[Flown], Case]) -> set[Future[Flown]]:
    if not air:
        sleep(POLL_SECONDS)
        return set()
    try:
        return set(wait(list(air), timeout=POLL_SECONDS, return_when="FIRST_COMPLETED").done)
    except TimeoutError:
        return set()


def _result(future: Future[Flown]) -> Flown | Lost | None:
    """What came of a case: whatever it did itself is a result, so an error here is one of the machinery.

    None where the worker died with a finished result: it is flown for again, which may take as long as it likes.
    """
    try:
        error = future.exception(timeout=FETCH_SECONDS)
        if error is None:
            return future.result(timeout=FETCH_SECONDS)
    except TimeoutError:
        return None
    return Lost(f"lost: {type(error).__name__}", str(error))
