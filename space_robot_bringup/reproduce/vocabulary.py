"""The names a manifest may use of its runs: metrics and signals, known before anything is flown."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_bringup.compose import compose
from space_robot_bringup.metrics import metric_names
from space_robot_bringup.reproduce.measures import OUTCOMES
from space_robot_bringup.reproduce.plan import PlannedRun
from space_robot_bringup.reproduce.signals import signal_names
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError

LAW_SIGNALS = ("controller.", "estimate/", "mismatch/")


class Vocabulary:
    """Metrics and signals of each flight, by composing it and asking for its first state."""

    def __init__(self) -> None:
        self._metrics: dict[str, list[str]] = {}
        self._signals: dict[str, list[str]] = {}
        self._silent: set[str] = set()

    def learn(self, run: PlannedRun, key: str) -> None:
        """Compose a run, once per flight.

        Raises:
            SpecError: it cannot be flown.
        """
        flight = run.flight
        if flight.name in self._metrics:
            return
        try:
            composition = compose(flight.experiment)
            self._signals[flight.name], telling = signal_names(composition)
        except SpaceRobotError as error:
            raise SpecError(f"{run.label} cannot be flown: {error}", key=key) from None
        flying = composition.nominal.base_mode == "free_flying"
        self._metrics[flight.name] = [*OUTCOMES, *metric_names(composition.joint_names, base_translation=flying)]
        if not telling:
            self._silent.add(flight.name)

    def check_metric(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a metric that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            _check("metric", name, self._metrics[run.flight.name], run, key)

    def check_signal(self, name: str, runs: Sequence[PlannedRun], key: str) -> None:
        """Refuse a signal that one of the runs does not have.

        Raises:
            SpecError: with the nearest names.
        """
        for run in runs:
            if run.flight.name not in self._silent or not name.startswith(LAW_SIGNALS):
                _check("signal", name, self._signals[run.flight.name], run, key)


def _check(kind: str, name: str, names: Sequence[str], run: PlannedRun, key: str) -> None:
    if name not in names:
        # Every element of every block would bury the message.
        accepted = nearest(name, names) or ", ".join(n for n in names if "[" not in n and n.count("/") < 2)
        raise SpecError(f"{run.label} has no such {kind}", key=key, value=name, accepted=accepted)
