"""How long a law takes per control cycle: its answers to the states of a recorded run, timed one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter_ns
from typing import TYPE_CHECKING

import numpy as np

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Reference, RobotState
from space_robot_msgs_py.log.reader import LogReader
from space_robot_studies.reproduce.run_data import CYCLE_TIMES

if TYPE_CHECKING:
    from space_robot_control.laws.base import Law

NANOSECONDS_PER_MICROSECOND = 1e3


@dataclass(frozen=True, slots=True)
class CycleTimes:
    """Wall time of one update of a law on this machine [us]."""

    mean: float
    median: float
    p99: float
    repeats: int

    def metrics(self) -> dict[str, float]:
        """By the names a manifest uses."""
        return dict(zip(CYCLE_TIMES, (self.mean, self.median, self.p99), strict=True))


def time_law(argument: str, overrides: tuple[str, ...], log: Path, repeats: int) -> CycleTimes | None:
    """Time ``update`` over the states and references of a log, again from its start as often as it takes.

    Args:
        argument: experiment, as ``load_experiment`` takes it.
        overrides: likewise.
        log: a run of this experiment.
        repeats: number of updates timed.

    Returns:
        The times; None if the law fails on these states.
    """
    ticks = [(tick.sample.state, tick.reference) for tick in LogReader(log).ticks()]
    return time_updates(compose(load_experiment(argument, overrides)).controller(), ticks, repeats)


def time_updates(law: Law, ticks: Sequence[tuple[RobotState, Reference]], repeats: int) -> CycleTimes | None:
    """Time ``update`` of a law over states and references; see ``time_law``.

    Args:
        law: fresh.
        ticks: of a run of it, in order.
        repeats: number of updates timed.

    Returns:
        The times; None if there are no ticks or the law fails on these states.
    """
    if not ticks:
        return None
    spent = np.empty(repeats)
    try:
        # A first lap, not counted, fills the caches.
        for state, reference in ticks:
            law.update(state, reference)
        for index in range(repeats):
            state, reference = ticks[index % len(ticks)]
            if index % len(ticks) == 0:
                law.reset()
            begun = perf_counter_ns()
            law.update(state, reference)
            spent[index] = perf_counter_ns() - begun
    except SpaceRobotError:
        return None
    spent /= NANOSECONDS_PER_MICROSECOND
    p99 = float(np.percentile(spent, 99))
    return CycleTimes(float(spent.mean()), float(np.median(spent)), p99, repeats)
