"""The names a manifest may use of its runs: metrics and signals, known before anything is flown."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.metrics import metric_names
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.reproduce.measures import OUTCOMES
from space_robot_studies.reproduce.plan import PlannedRun
from space_robot_studies.reproduce.signals import signal_names

LAW_SIGNALS = ("controller.", "estimate/", "mismatch/")


@dataclass(frozen=True, slots=True)
class _Words:
    metrics: tuple[str, ...]
    signals: tuple[str, ...]
    law_tells: bool


class Vocabulary:
    """Metrics and signals of each flight, by composing it and asking for its first state."""

    def __init__(self) -> None:
        self._of_flight: dict[str, _Words] = {}
        self._of_content: dict[str, _Words] = {}

    def learn(self, run: PlannedRun, key: str) -> None:
        """Compose a run, unless one that differs only by its seed has been: what that draws is known when it flies.

        Raises:
            SpecError: it cannot be flown.
        """
        experiment = run.flight.experiment
        content = experiment.model_dump_json(exclude={"seed"})
        if content not in self._of_content:
            try:
                self._of_content[content] = _words(experiment)
            except SpaceRobotError as error:
                raise SpecError(f"{run.label} cannot be flown: {error}", key=key) from None
        self._of_flight[run.flight.name] = self._of_content[content]

    def learn_case(self, run: PlannedRun, first: PlannedRun) -> None:
        """Take a case of a campaign to have the names of the first of its point, which has been learnt."""
        self._of_flight[run.flight.name] = self._of_flight[first.flight.name]

    def check_metric(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a metric that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            _check("metric", name, self._of_flight[run.flight.name].metrics, run, key)

    def check_signal(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a signal that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            words = self._of_flight[run.flight.name]
            if words.law_tells or not name.startswith(LAW_SIGNALS):
                _check("signal", name, words.signals, run, key)


def _words(experiment: Experiment) -> _Words:
    composition = compose(experiment)
    flying = composition.nominal.base_mode == "free_flying"
    metrics = metric_names(composition.joint_names, base_translation=flying)
    signals, law_tells = signal_names(composition)
    return _Words((*OUTCOMES, *metrics), tuple(signals), law_tells)


def _check(kind: str, name: str, names: Collection[str], run: PlannedRun, key: str) -> None:
    if name not in names:
        # Every element of every block would bury the message.
        accepted = nearest(name, names) or ", ".join(n for n in names if "[" not in n and n.count("/") < 2)
        raise SpecError(f"{run.label} has no such {kind}", key=key, value=name, accepted=accepted)
