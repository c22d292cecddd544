"""Flies cases on the workers of a client, a few ahead of who is free."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError

from distributed import Client, Future, wait
from distributed.comm.core import CommClosedError

from space_robot_bringup.campaign.cases import Case
from space_robot_bringup.campaign.fly import Flown, Keep, fly_case
from space_robot_msgs_py.errors import SilenceError

# Enough that nobody waits for the next case, few enough that bags do not pile up where they were made.
AHEAD = 3
POLL_SECONDS = 0.2


def fly_cases(
    client: Client, cases: Iterator[Case], keep: Keep, stop: Callable[[], str | None]
) -> Iterator[tuple[Case, Flown | str]]:
    """Every case with what came of it, in the order in which they land; a worker that dies is flown for by another.

    Args:
        client: of ready workers.
        cases: to fly.
        keep: whose bags come back.
        stop: asked often; a reason ends it, what is in the air is left there.

    Yields:
        The case and its result, or the reason why there is none.

    Raises:
        SilenceError: the scheduler is gone.
    """
    air: dict[Future[Flown], Case] = {}
    try:
        while stop() is None:
            for case in _next(cases, AHEAD * max(1, len(client.nthreads())) - len(air)):
                air[client.submit(fly_case, case.data, name_of(case), keep, pure=False)] = case
            if not air:
                return
            for future in _landed(air):
                yield air.pop(future), _result(future)
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
    try:
        return set(wait(list(air), timeout=POLL_SECONDS, return_when="FIRST_COMPLETED").done)
    except TimeoutError:
        return set()


def _result(future: Future[Flown]) -> Flown | str:
    """The result, or why there is none: what the case did itself is a result, so this was the machinery."""
    error = future.exception()
    if error is None:
        return future.result()
    return f"lost: {type(error).__name__}: {' '.join(str(error).split())}"
