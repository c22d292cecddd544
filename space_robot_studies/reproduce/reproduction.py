"""A paper reproduced: everything checked, everything run, the claims judged."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.versions import versions
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import InputFileError, SilenceError, SpecError
from space_robot_studies.campaign.directory import CAMPAIGN
from space_robot_studies.campaign.kinds import kind_of_experiment
from space_robot_studies.engine.groups import Grouping, run_in_groups
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.engine.journal import ROWS, RUNS, Journal, Row, bag_path, locked, open_journal
from space_robot_studies.engine.storage import check_place, guarded
from space_robot_studies.engine.tasks import TIME_LIMIT, Lost, Stop, Task, Workers
from space_robot_studies.engine.workers import check_workers, open_workers
from space_robot_studies.reproduce.check import check_plan
from space_robot_studies.reproduce.claims import Judgement, judge
from space_robot_studies.reproduce.jobs import job_of
from space_robot_studies.reproduce.manifest import Figure
from space_robot_studies.reproduce.measures import FinishedRun
from space_robot_studies.reproduce.plan import Plan, choose_figures, load_plan
from space_robot_studies.reproduce.planner import PlannedRun
from space_robot_studies.reproduce.run import Job, run_job, run_jobs
from space_robot_studies.reproduce.run_data import RunData
from space_robot_studies.reproduce.timing import CycleTimes, time_law

CLAIMS = "claims.json"


@dataclass(frozen=True, slots=True)
class FigureResult:
    """A figure and everything known about it.

    Attributes:
        name: number or name.
        figure: from the manifest.
        runs: in order.
        read: runs that only readings of its claims have.
        times: cycle times by group, where the figure has a timing table.
        judgements: of the claims, in order.
    """

    name: str
    figure: Figure
    runs: tuple[FinishedRun, ...]
    read: tuple[FinishedRun, ...]
    times: dict[str, CycleTimes]
    judgements: tuple[Judgement, ...]

    @property
    def failures(self) -> list[FinishedRun]:
        """Runs that failed unexpectedly; that the run of a reading fails is a result, that a run is lost never is."""
        expected = [
            *((pair, self.figure.runs[pair[0].group].may_fail) for pair in self.runs),
            *((p, True) for p in self.read),
        ]
        return [pair for pair, may_fail in expected if not pair[1].completed and (pair[1].lost or not may_fail)]


@dataclass(frozen=True, slots=True)
class Reproduction:
    """What a reproduction came to.

    Attributes:
        plan: of the paper.
        directory: where its bags and rows are.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        figures: the chosen ones, in order; empty unless completed.
    """

    plan: Plan
    directory: Path
    end_reason: str
    figures: tuple[FigureResult, ...] = ()

    @property
    def passed(self) -> bool:
        """Every verdict is the documented one, and no run failed that should not."""
        return self.end_reason == "completed" and passed(self.figures)


def passed(figures: Sequence[FigureResult]) -> bool:
    """Every verdict of these figures is the documented one, and no run failed that should not."""
    return not any(figure.failures or any(one.changed for one in figure.judgements) for figure in figures)


def reproduce(
    paper: Plan | str | Path,
    directory: str | Path,
    *,
    figures: Sequence[str] = (),
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> Reproduction:
    """Run the figures of a paper and judge its claims; the result does not depend on the number of workers.

    Args:
        paper: a shipped name, a manifest file, or what ``load_plan`` made of one.
        directory: new, empty, or of an earlier reproduction, whose runs are replaced.
        figures: which; none: all.
        workers: number of processes; None: one per core.
        resume: keep the finished runs in the directory that are still the same.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the manifest or an option is wrong, and nothing was written; or a bag cannot be written.
    """
    hooks, place = hooks or StudyHooks(), Path(directory)
    check_workers(workers, None, time_limit)
    plan = paper if isinstance(paper, Plan) else load_plan(paper)
    chosen = choose_figures(plan.manifest, figures)
    # First: a plan with custom laws is checked in workers.
    _check_directory(place)
    check_plan(plan, chosen, time_limit)
    first = next(iter(plan.distinct_runs(chosen).values())).experiment
    with (
        open_workers(workers, time_limit=time_limit, warm=(warm, (first,)), stop=hooks.stop) as pool,
        locked(place),
    ):
        with guarded(place):
            if not resume:
                (place / ROWS).unlink(missing_ok=True)
            (place / RUNS).mkdir(exist_ok=True)
        with open_journal(place, versions(), time_limit) as journal:
            return _Study(plan, chosen, journal, pool, hooks.stop).result(hooks)


def warm(experiment: Experiment) -> None:
    """Load, or compile, what runs of an experiment need: plant and law are made."""
    compose(experiment).plant().reset()


def _check_directory(directory: Path) -> None:
    accepted = "a directory, new, empty or of an earlier reproduction"
    check_place(directory, accepted)
    try:
        if (directory / CAMPAIGN).exists():
            raise SpecError("holds a campaign", key="--out", value=str(directory), accepted=accepted)
        resumable = any((directory / name).exists() for name in (RUNS, CLAIMS))
        free = not directory.exists() or (directory.is_dir() and (resumable or not any(directory.iterdir())))
    except SpecError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputFileError(f"cannot be read: {reason}", key="--out", value=str(directory)) from None
    if not free:
        raise InputFileError("holds something else", key="--out", value=str(directory), accepted=accepted)


class _Study:
    """The runs of the chosen figures, those of the journal and those to be done."""

    def __init__(self, plan: Plan, figures: Sequence[str], journal: Journal, pool: Workers, stop: Stop) -> None:
        self._plan, self._figures, self._journal, self._pool, self._stop = plan, figures, journal, pool, stop
        self._distinct = plan.distinct_runs(figures)
        self._jobs = {name: job_of(plan, figures, run, journal.directory) for name, run in self._distinct.items()}
        robots: dict[str, Mapping[str, Any]] = {}
        self._digests = {
            name: self._jobs[name].digest(run.experiment, _robot(run.experiment, robots))
            for name, run in self._distinct.items()
        }

    def result(self, hooks: StudyHooks) -> Reproduction:
        """Do what is not finished yet, and judge."""
        data = {name: found for name in self._distinct if (found := self._finished(name)) is not None}
        hooks.on_ready(len(data), len(self._distinct))
        reason = ""
        try:
            pool, grouping = self._pool, Grouping(self._kind, run_jobs)
            pending, count = self._pending(set(data)), len(self._distinct) - len(data)
            for task, outcome in run_in_groups(pool, pending, count, grouping, self._stop):
                data[str(task.key)] = self._enter(str(task.key), outcome)
                hooks.on_row(len(data))
            if len(data) == len(self._distinct):
                # One after the other: neighbours would share the cores and the caches.
                times = {name: self._time(name, data) for name in self._figures}
        except SilenceError as error:
            reason = str(error)
        reason = reason or self._stop() or ("completed" if len(data) == len(self._distinct) else "interrupted")
        if reason != "completed":
            return Reproduction(self._plan, self._journal.directory, reason)
        judged = tuple(_figure(self._plan, name, data, times[name]) for name in self._figures)
        return Reproduction(self._plan, self._journal.directory, reason, judged)

    def _finished(self, name: str) -> RunData | None:
        """What the journal has of a run, if it is still the same one and its bag is where it was."""
        row = self._journal.rows.get(name)
        if row is None or row.columns.get("digest") != self._digests[name]:
            return None
        try:
            data = RunData.from_columns(row.columns)
        except (KeyError, TypeError, ValueError):
            return None
        return data if not data.bag or bag_path(self._journal.directory, name).is_dir() else None

    def _pending(self, finished: set[str]) -> Iterator[Task[RunData]]:
        for name, job in self._jobs.items():
            if name not in finished:
                yield Task(name, run_job, (job,))

    def _kind(self, task: Task[RunData]) -> Hashable | None:
        return kind_of_experiment(self._distinct[str(task.key)].experiment)

    def _enter(self, name: str, outcome: RunData | Lost) -> RunData:
        digest = {"digest": self._digests[name]}
        if isinstance(outcome, Lost):
            if outcome.error is not None:
                raise outcome.error
            data = RunData(outcome.reason, lost=True)
            self._journal.append(Row.of_lost(name, digest | data.to_columns(), outcome))
            return data
        self._journal.append(Row(name, digest | outcome.to_columns()))
        return outcome

    def _time(self, figure: str, data: Mapping[str, RunData]) -> dict[str, CycleTimes]:
        timing = self._plan.manifest.figures[figure].timing
        times: dict[str, CycleTimes] = {}
        for group in timing.of if timing else ():
            (run,) = self._plan.runs[figure][group]
            if timing is None or not data[run.distinct.name].completed:
                continue
            job: Job = self._jobs[run.distinct.name]
            task = Task(group, time_law, (job.argument, job.overrides, job.directory, timing.repeats))
            for _, outcome in self._pool.run([task], self._stop):
                if isinstance(outcome, CycleTimes):
                    times[group] = outcome
        return times


def _robot(experiment: Experiment, known: dict[str, Mapping[str, Any]]) -> Mapping[str, Any]:
    """Content of the robot file; reading it takes longer than everything else about a run."""
    if not isinstance(experiment.robot, str):
        return {}
    if experiment.robot not in known:
        known[experiment.robot] = load_robot(experiment.robot).resolved
    return known[experiment.robot]


def _figure(plan: Plan, name: str, data: Mapping[str, RunData], times: dict[str, CycleTimes]) -> FigureResult:
    figure = plan.manifest.figures[name]

    def finished(run: PlannedRun) -> RunData:
        one = data[run.distinct.name]
        return replace(one, cycle_times=times[run.group].metrics()) if run.group in times else one

    runs, read = (tuple((run, finished(run)) for run in part) for part in (plan.shown(name), plan.only_read(name)))
    claims = zip(figure.claims, plan.read[name], strict=True)
    judgements = tuple(judge(claim, figure, readings, finished) for claim, readings in claims)
    return FigureResult(name, figure, runs, read, times, judgements)
