"""A paper reproduced: check everything, fly everything, judge the claims."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from space_robot_bringup.reproduce.check import check_plan
from space_robot_bringup.reproduce.claims import Judgement, judge
from space_robot_bringup.reproduce.fly import Job, Keep, fly
from space_robot_bringup.reproduce.measures import Flight, FlownRun, select
from space_robot_bringup.reproduce.numbers import Asked, Quantity
from space_robot_bringup.reproduce.plan import Plan, PlannedFlight, PlannedRun
from space_robot_bringup.reproduce.spec import KEEP_ALL_UP_TO, Figure
from space_robot_bringup.reproduce.timing import CycleTimes, time_law
from space_robot_bringup.reproduce.workers import Task, Workers
from space_robot_msgs_py.errors import InputFileError, LogError, SpecError

RUNS, CLAIMS = "runs", "claims.json"
MOST_WORKERS = 256


@dataclass(frozen=True, slots=True)
class FlownFigure:
    """A figure and everything known about it.

    Attributes:
        name: number or name.
        figure: from the manifest.
        runs: in order.
        times: cycle times by group, where asked for.
        judgements: of the claims, in order.
    """

    name: str
    figure: Figure
    runs: tuple[FlownRun, ...]
    times: dict[str, CycleTimes]
    judgements: tuple[Judgement, ...]

    @property
    def failures(self) -> list[FlownRun]:
        """Runs that failed though the manifest does not expect it."""
        return [
            (run, flight) for run, flight in self.runs if not (flight.completed or self.figure.runs[run.group].may_fail)
        ]


def check_workers(workers: int | None) -> None:
    """Refuse a number of worker processes that cannot be; None is one per core.

    Raises:
        SpecError: it cannot.
    """
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise SpecError("not a usable number", key="--workers", value=workers, accepted=f"1 to {MOST_WORKERS}")


def prepare(plan: Plan, figures: Sequence[str], directory: Path) -> None:
    """Everything that can be refused before a flight.

    Raises:
        SpecError: see ``check_plan``.
        InputFileError: the directory holds something else.
    """
    check_plan(plan, figures)
    try:
        ours = any((directory / name).exists() for name in (RUNS, CLAIMS))
        free = not directory.exists() or (directory.is_dir() and (ours or not any(directory.iterdir())))
    except OSError as error:
        raise InputFileError(f"cannot be read: {error.strerror}", key="--out", value=str(directory)) from None
    if not free:
        accepted = "a directory, new, empty or of an earlier reproduction"
        raise InputFileError("holds something else", key="--out", value=str(directory), accepted=accepted)


def reproduce(
    plan: Plan,
    figures: Sequence[str],
    directory: Path,
    *,
    workers: int,
    on_done: Callable[[int], None] = lambda done: None,
    stop: Callable[[], str | None] = lambda: None,
) -> list[FlownFigure] | None:
    """Fly the figures and judge their claims; the result does not depend on the number of workers.

    Args:
        plan: of the paper, prepared.
        figures: which, in order.
        directory: bags go to ``runs/`` in it.
        workers: number of processes.
        on_done: told how many flights are done.
        stop: asked often; a reason ends everything.

    Returns:
        The figures; None if there was a reason to stop.

    Raises:
        SpaceRobotError: a log cannot be written, or a worker died.
    """
    planned = plan.flights(figures)
    try:
        (directory / RUNS).mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise LogError(f"cannot be made: {error}", key="--out", value=str(directory)) from None
    jobs = [_job(plan, figures, flight, directory) for flight in planned.values()]
    with Workers(min(workers, len(jobs)), stop) as pool:
        flown = pool.run([(fly, (job,)) for job in jobs], on_done)
        if flown is None:
            return None
        flights = dict(zip(planned, flown, strict=True))
        times: dict[str, dict[str, CycleTimes]] = {}
        for name in figures:
            # One after the other: neighbours would share the cores and the caches.
            found = _time(plan, name, flights, directory, pool)
            if found is None:
                return None
            times[name] = found
    return [_figure(plan, name, flights, times[name]) for name in figures]


def _figure(plan: Plan, name: str, flights: dict[str, Flight], times: dict[str, CycleTimes]) -> FlownFigure:
    figure = plan.manifest.figures[name]
    runs = []
    for run in (run for group in plan.runs[name].values() for run in group):
        flight = flights[run.flight.name]
        if run.group in times:
            flight = replace(flight, cycle_times=times[run.group].metrics())
        runs.append((run, flight))
    judgements = tuple(judge(claim, figure, runs) for claim in figure.claims)
    return FlownFigure(name, figure, tuple(runs), times, judgements)


def _job(plan: Plan, figures: Sequence[str], flight: PlannedFlight, directory: Path) -> Job:
    quantities: dict[Quantity, None] = {}
    curves: dict[str, None] = {}
    keeps: set[Keep] = set()
    for name in figures:
        figure = plan.manifest.figures[name]
        runs = [run for group in plan.runs[name].values() for run in group]
        mine = {run.group for run in runs if run.flight is flight}
        if not mine:
            continue
        for panel in figure.panels:
            if mine & set(panel.of or mine):
                curves |= dict.fromkeys(panel.signals)
        quantities |= {number.quantity: None for number in _numbers(figure, runs, flight) if number.signal}
        timed = figure.timing is not None and mine & set(figure.timing.of)
        keeps.add("all" if timed else figure.keep or ("all" if len(runs) <= KEEP_ALL_UP_TO else "failed"))
    keep: Keep = "all" if "all" in keeps else "failed" if "failed" in keeps else "none"
    place = (directory / RUNS / flight.name).resolve()
    return Job(flight.argument, flight.overrides, place, tuple(quantities), tuple(curves), keep)


def _numbers(figure: Figure, runs: Sequence[PlannedRun], flight: PlannedFlight) -> Iterator[Asked]:
    """Everything a figure asks of a flight."""
    mine = {run.group for run in runs if run.flight is flight}
    for chart in (*figure.charts, *figure.grids):
        if mine & set(chart.of or mine):
            yield chart.measure
    for table in figure.tables:
        if mine & set(table.of or mine):
            yield from table.columns.values()
    for claim in figure.claims:
        for measure in claim.measures.values():
            if any(run.flight is flight for run in select(measure, runs)):
                yield measure
            if measure.only_if is not None and mine & set(measure.only_if.groups):
                yield measure.only_if


def _time(
    plan: Plan, name: str, flights: dict[str, Flight], directory: Path, pool: Workers
) -> dict[str, CycleTimes] | None:
    timing = plan.manifest.figures[name].timing
    times: dict[str, CycleTimes] = {}
    for group in timing.of if timing else ():
        (run,) = plan.runs[name][group]
        if timing is None or not flights[run.flight.name].completed:
            continue
        log = (directory / RUNS / run.flight.name).resolve()
        task: Task[CycleTimes | None] = (time_law, (run.flight.argument, run.flight.overrides, log, timing.repeats))
        result = pool.run([task], lambda done: None)
        if result is None:
            return None
        if result[0] is not None:
            times[group] = result[0]
    return times
