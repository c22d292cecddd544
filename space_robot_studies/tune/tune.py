"""One tuning from beginning to end: checked, searched, the best gains tried on draws that the search never saw."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.compose.versions import versions
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.judge.metrics import metric_names
from space_robot_msgs_py.errors import SilenceError, SpaceRobotError, SpecError
from space_robot_msgs_py.extras import install
from space_robot_studies.campaign.run_case import warm
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.engine.groups import run_in_groups
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.engine.journal import Journal, Row
from space_robot_studies.engine.tasks import TIME_LIMIT, Lost, Task, Workers
from space_robot_studies.engine.workers import check_workers, open_workers
from space_robot_studies.tune.candidate import GROUPING, Judge, evaluate, experiment_of
from space_robot_studies.tune.directory import Draws, check_directory, columns, known, open_tuning
from space_robot_studies.tune.outcome import StandResult, TuningResult, write_result
from space_robot_studies.tune.ranking import Evaluation
from space_robot_studies.tune.spec import Tuning
from space_robot_studies.tune.stand import Stand, make_stands

# What the extra for many runs brings.
NEEDED = ("cmaes", "scipy", "pyarrow")


@dataclass(frozen=True, slots=True)
class Trial:
    """An evaluation that is to be done.

    Attributes:
        stand: law and point.
        kind: ``search``, ``sensitivity``, ``held_out_shipped`` or ``held_out_best``.
        number: in its kind.
        gains: dotted name to value.
        draws: numbers of the draws.
    """

    stand: Stand
    kind: str
    number: int
    gains: Mapping[str, float]
    draws: range

    @property
    def key(self) -> str:
        """Its row."""
        return f"{self.stand.name}/{self.stand.point}/{self.kind}/{self.number:04d}"


def run_tuning(
    tuning: Tuning,
    directory: Path,
    *,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> TuningResult:
    """Search the gains of every law of a resolved file at every point of its grid.

    Args:
        tuning: see ``load_tuning``.
        directory: new or empty, or to resume.
        workers: local processes; None: one per core. They change no evaluation.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of an evaluation; ten times as much may elapse.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the file cannot be used as it is, and nothing was written; or no evaluation came to a number.
    """
    hooks = hooks or StudyHooks()
    check_workers(workers, None, time_limit)
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        raise SpecError(f"tuning needs {missing[0]}", accepted=install("campaign"))
    check_directory(directory, tuning, resume=resume)
    stands, campaign = make_stands(tuning), tuning.campaign()
    judge, warnings = check_task(tuning, campaign, stands)
    for warning in warnings:
        hooks.warn(warning)
    first = (warm, (experiment_of(campaign, 0, 0, stands[0].law, {}),))
    with (
        open_tuning(directory, tuning, versions(), time_limit) as journal,
        open_workers(workers, time_limit=time_limit, warm=first, stop=hooks.stop) as pool,
    ):
        session = Session(tuning, campaign, judge, journal, pool, hooks)
        return session.run(stands)


def check_task(tuning: Tuning, campaign: Campaign, stands: Sequence[Stand]) -> tuple[Judge, list[str]]:
    """Compose every law at every point with the gains of the file.

    Returns:
        What reads a run, and what the laws warn of.

    Raises:
        SpaceRobotError: one cannot be run; the message names law and point.
    """
    judge: Judge | None = None
    warnings: dict[str, None] = {}
    for stand in stands:
        composition = _composed(campaign, stand)
        warnings |= dict.fromkeys(composition.review().warnings)
        if judge is None:
            judge = _judge(tuning, composition)
    assert judge is not None
    return judge, list(warnings)


def _composed(campaign: Campaign, stand: Stand) -> Composition:
    try:
        return compose(experiment_from(experiment_of(campaign, stand.point, 0, stand.law, {}), stand.where))
    except SpaceRobotError as error:
        raise SpecError(
            f"cannot be run: {error}", key=f"laws.{stand.where}", accepted="gains that can be run"
        ) from None


def _judge(tuning: Tuning, composition: Composition) -> Judge:
    experiment, robot = composition.experiment, composition.nominal
    angles = tuple(name for name, length in zip(robot.joint_names, robot.prismatic, strict=True) if not length)
    bands = tuple(experiment.settling_bands)
    judge = Judge(tuning.objective, tuning.constraints, angles, bands, experiment.duration)
    flying = robot.base_mode == "free_flying"
    judge.check(metric_names(composition.joint_names, base_translation=flying))
    return judge


@dataclass(slots=True)
class Session:
    """A tuning that is going on."""

    tuning: Tuning
    campaign: Campaign
    judge: Judge
    journal: Journal
    pool: Workers
    hooks: StudyHooks
    done: int = 0

    def run(self, stands: Sequence[Stand]) -> TuningResult:
        """Search, look around the best, judge it on the held-out draws, write everything."""
        total = sum(self.tuning.budget + 2 * len(stand.ranges) + 2 * self.tuning.held_out for stand in stands)
        self.hooks.on_ready(0, total)
        place, results = self.journal.directory, list[StandResult]()
        try:
            if self._search(stands):
                if all(stand.best.objective is None for stand in stands):
                    reason = stands[0].best.draws[0]["end_reason"]
                    what = f"no evaluation came to a number; the first of {stands[0].where} ended: {reason}"
                    raise SpecError(what, key="objective", accepted="a task that a law completes with some gains")
                results = self._conclude(stands)
        except SilenceError as error:
            return TuningResult(place, str(error), self.done, total)
        if len(results) < len(stands):
            return TuningResult(place, self.hooks.stop() or "interrupted", self.done, total)
        result = TuningResult(place, "completed", self.done, total, tuple(results))
        write_result(result, self.tuning)
        return result

    def _search(self, stands: Sequence[Stand]) -> bool:
        """Whether every search came to its end."""
        draws = range(self.tuning.draws)
        if not self._evaluate([Trial(stand, "search", 0, {}, draws) for stand in stands]):
            return False
        while batches := [(stand, batch) for stand in stands if (batch := stand.search.ask())]:
            trials = [
                Trial(stand, "search", len(stand.evaluations) + k, stand.gains(candidate), draws)
                for stand, batch in batches
                for k, candidate in enumerate(batch)
            ]
            if not self._evaluate(trials):
                return False
            for stand, batch in batches:
                stand.search.tell(batch, [one.rank for one in stand.evaluations[-len(batch) :]])
        return True

    def _evaluate(self, trials: Sequence[Trial]) -> bool:
        """Try all of them, and enter each at its stand; False where the tuning was stopped before."""
        found = self._try(trials)
        if found is None:
            return False
        for trial, draws in zip(trials, found, strict=True):
            one = Evaluation(trial.number, trial.gains, tuple(draws), self.tuning.objective.over)
            trial.stand.evaluations.append(one)
        return True

    def _conclude(self, stands: Sequence[Stand]) -> list[StandResult]:
        """Neighbours of the best gains, and both settings on the held-out draws."""
        first, last = self.tuning.draws, self.tuning.draws + self.tuning.held_out
        trials: list[Trial] = []
        for stand in stands:
            best = stand.best.gains
            # The shipped gains need not be numbers that have neighbours.
            around = stand.neighbours(best) if best else []
            trials += [Trial(stand, "sensitivity", k, one, range(first)) for k, one in enumerate(around)]
            for kind, gains in (("held_out_shipped", {}), ("held_out_best", best)):
                trials += [Trial(stand, kind, k, gains, range(k, k + 1)) for k in range(first, last)]
        found = self._try(trials)
        if found is None:
            return []
        done = [(trial, draws) for trial, draws in zip(trials, found, strict=True)]
        return [self._result(stand, [(t, d) for t, d in done if t.stand is stand]) for stand in stands]

    def _result(self, stand: Stand, done: Sequence[tuple[Trial, Draws]]) -> StandResult:
        over = self.tuning.objective.over
        near = [Evaluation(t.number, t.gains, tuple(d), over) for t, d in done if t.kind == "sensitivity"]
        held = {
            kind: Evaluation(0, gains, tuple(draw for t, d in done if t.kind == kind for draw in d), over)
            for kind, gains in (("held_out_shipped", stand.shipped.gains), ("held_out_best", stand.best.gains))
        }
        return StandResult(
            name=stand.name,
            law=stand.law,
            where=stand.where,
            labels=dict(stand.labels),
            ranges=dict(stand.ranges),
            evaluations=tuple(stand.evaluations),
            best=stand.best,
            neighbours=tuple(near),
            held_out_shipped=held["held_out_shipped"],
            held_out_best=held["held_out_best"],
        )

    def _try(self, trials: Sequence[Trial]) -> list[Draws] | None:
        """What came of each, in their order; None where the tuning was stopped before all were done."""
        found = {trial.key: draws for trial in trials if (draws := known(self.journal, trial.key, trial.gains))}
        self._count(len(found))
        by_key = {trial.key: trial for trial in trials}
        tasks, count = self._tasks(trials, found), len(trials) - len(found)
        for task, outcome in run_in_groups(self.pool, tasks, count, GROUPING, self.hooks.stop):
            trial = by_key[str(task.key)]
            found[trial.key] = self._enter(trial, outcome)
            self._count(1)
        if len(found) < len(trials):
            return None
        return [found[trial.key] for trial in trials]

    def _count(self, more: int) -> None:
        self.done += more
        self.hooks.on_row(self.done)

    def _tasks(self, trials: Sequence[Trial], found: Mapping[str, Draws]) -> Iterator[Task[list[dict[str, object]]]]:
        for trial in trials:
            if trial.key not in found:
                stand = trial.stand
                experiments = [
                    experiment_of(self.campaign, stand.point, draw, stand.law, trial.gains) for draw in trial.draws
                ]
                yield Task(trial.key, evaluate, (experiments, self.judge))

    def _enter(self, trial: Trial, outcome: list[dict[str, object]] | Lost) -> Draws:
        if isinstance(outcome, Lost):
            failed = {"end_reason": outcome.reason, "objective": None, "excess": None}
            draws: Draws = [failed for _ in trial.draws]
            self.journal.append(Row.of_lost(trial.key, columns(trial.gains, draws), outcome))
            return draws
        # As they come back from the journal: a resumed tuning sees the same numbers.
        draws = json.loads(columns(trial.gains, outcome)["draws"])
        self.journal.append(Row(trial.key, columns(trial.gains, draws)))
        return draws
