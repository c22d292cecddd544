"""The names a manifest may use of its runs: metrics and signals, known before the first run."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.metrics import metric_names
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.engine.tasks import Lost, Task
from space_robot_studies.reproduce.planner import PlannedRun
from space_robot_studies.reproduce.run_data import OUTCOMES
from space_robot_studies.reproduce.signals import signal_names

LAW_SIGNALS = ("controller.", "estimate/", "mismatch/")


@dataclass(frozen=True, slots=True)
class Words:
    """Names of the metrics and signals of a run, and whether those of its law are among them."""

    metrics: tuple[str, ...]
    signals: tuple[str, ...]
    law_labels: bool


class Vocabulary:
    """Metrics and signals of each run, by composing it and taking its first state; use it as a context manager.

    The first answer of a custom law is computed in a worker process, which the law may kill or never leave.

    Args:
        time_limit: [s] of CPU time of a first answer.
    """

    def __init__(self, time_limit: float) -> None:
        self._limit = time_limit
        self._stack = ExitStack()
        self._workers: LocalWorkers | None = None
        self._of_run: dict[str, Words] = {}
        self._of_content: dict[str, Words] = {}

    def __enter__(self) -> Vocabulary:
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def learn(self, run: PlannedRun, key: str) -> None:
        """Compose a run, unless one that differs only by its seed has been: what that draws is known when it runs.

        Raises:
            SpecError: it cannot be run.
        """
        experiment = run.distinct.experiment
        content = experiment.model_dump_json(exclude={"seed"})
        if content not in self._of_content:
            try:
                self._of_content[content] = self._learn(experiment)
            except SpaceRobotError as error:
                raise SpecError(f"{run.label} cannot be run: {error}", key=key) from None
        self._of_run[run.distinct.name] = self._of_content[content]

    def _learn(self, experiment: Experiment) -> Words:
        # Only here: the page of a log, which takes its headings from this package, needs no law and no compiler.
        from space_robot_control.laws.registry import BUILT_IN

        if set(experiment.controller.law_names) <= set(BUILT_IN):
            return words_of(experiment)
        if self._workers is None:
            self._workers = self._stack.enter_context(LocalWorkers(1, self._limit))
        # Without its answer the names of its own telemetry are not known; that it gives none is for the run to show.
        for answered in (True, False):
            ((_, found),) = self._workers.run([Task("words", words_of, (experiment, answered))], lambda: None)
            if not isinstance(found, Lost):
                return found
            if found.error is not None:
                raise found.error
            reason = found.reason
        raise SpecError(reason)

    def learn_case(self, run: PlannedRun, first: PlannedRun) -> None:
        """Take a case of a campaign to have the names of the first of its point, which has been learnt."""
        self._of_run[run.distinct.name] = self._of_run[first.distinct.name]

    def check_metric(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a metric that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            _check("metric", name, self._of_run[run.distinct.name].metrics, run, key)

    def check_signal(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a signal that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            words = self._of_run[run.distinct.name]
            if words.law_labels or not name.startswith(LAW_SIGNALS):
                _check("signal", name, words.signals, run, key)


def words_of(experiment: Experiment, answered: bool = True) -> Words:
    """The names of an experiment.

    Args:
        experiment: it is composed.
        answered: the law answers the first state, to show its telemetry.
    """
    composition = compose(experiment)
    free_flying = composition.nominal.base_mode == "free_flying"
    metrics = metric_names(composition.joint_names, base_translation=free_flying)
    signals, law_labels = signal_names(composition, answered=answered)
    return Words((*OUTCOMES, *metrics), tuple(signals), law_labels)


def _check(kind: str, name: str, names: Collection[str], run: PlannedRun, key: str) -> None:
    if name not in names:
        # Every element of every block would bury the message.
        accepted = nearest(name, names) or ", ".join(n for n in names if "[" not in n and n.count("/") < 2)
        raise SpecError(f"{run.label} has no such {kind}", key=key, value=name, accepted=accepted)
