"""Numbers of runs: what each run has, and how many runs become one number."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.reproduce.estimate import Estimate, bootstrap, exact, share_of
from space_robot_studies.reproduce.manifest import Bounds
from space_robot_studies.reproduce.planner import PlannedRun
from space_robot_studies.reproduce.quantities import Measure, Number, Partners, Quantity
from space_robot_studies.reproduce.run_data import OUTCOMES, RunData

TAKES: dict[str, Callable[[Vector], float]] = {
    "final": lambda x: float(x[-1]),
    "max": lambda x: float(x.max()),
    "min": lambda x: float(x.min()),
    "mean": lambda x: float(x.mean()),
    "rms": lambda x: float(np.sqrt(np.mean(x**2))),
    "max_abs": lambda x: float(np.abs(x).max()),
}
REDUCTIONS: dict[str, Callable[[Vector], Estimate]] = {
    "min": lambda x: exact(float(x.min())),
    "max": lambda x: exact(float(x.max())),
    "mean": lambda x: bootstrap(x, np.mean),
    "median": lambda x: bootstrap(x, np.median),
    "std": lambda x: exact(float(x.std())),
    "sum": lambda x: exact(float(x.sum())),
}
OF_NONE = ("sum",)

FinishedRun = tuple[PlannedRun, RunData]


@dataclass(frozen=True, slots=True)
class Measured:
    """A number over runs.

    Attributes:
        estimate: with its interval; None if there is none, then ``why`` says why.
        runs: how many there are.
        without: labels of runs that lack the number.
        why: no value.
    """

    estimate: Estimate | None
    runs: int
    without: tuple[str, ...] = ()
    why: str = ""

    @property
    def value(self) -> float | None:
        """The number alone."""
        return None if self.estimate is None else self.estimate.value


def take(quantity: Quantity, time: Vector, signal: Vector) -> float | None:
    """The number taken of a signal in its window, ends included; None if it has no value in it, or never settles.

    Args:
        quantity: ``integral`` is that of a signal that is held between ticks, like a command.
        time: (K,) [s].
        signal: (K,); NaN where it has no value, and these ticks do not count.
    """
    end = np.inf if quantity.before is None else quantity.before
    inside = (time >= quantity.after) & (time <= end) & ~np.isnan(signal)
    t, x = time[inside], signal[inside]
    if not x.size:
        return None
    if quantity.take == "integral":
        return float(x[:-1] @ np.diff(t))
    if quantity.take == "settled":
        outside = np.flatnonzero(np.abs(x) >= quantity.below)
        first = int(outside[-1]) + 1 if outside.size else 0
        return float(t[first]) if first < t.size else None
    return TAKES[quantity.take](x)


def select(measure: Measure, runs: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The runs a measure is over."""
    return [run for run in runs if run.group in measure.groups and run.has(measure.where)]


def selected(measure: Measure, runs: Sequence[FinishedRun]) -> list[FinishedRun]:
    """Of finished runs those a measure is over."""
    return [pair for pair in runs if select(measure, [pair[0]])]


def divisors(measure: Measure, runs: Sequence[FinishedRun]) -> dict[int, RunData] | None:
    """By seed the runs that ``over`` divides by, of the same ``where``; None if it divides by none."""
    if not measure.over:
        return None
    return {run.seed: data for run, data in runs if run.group == measure.over and run.has(measure.where)}


def paired(
    measure: Measure, chosen: Sequence[FinishedRun], runs: Sequence[FinishedRun], bounds: Bounds
) -> list[FinishedRun]:
    """Those of the chosen runs that ``only_if`` leaves: every group it names has partners, and each has the number."""
    if measure.only_if is None:
        return list(chosen)
    return [pair for pair in chosen if _all_have(measure.only_if, pair[0].seed, runs, bounds)]


def _all_have(wanted: Partners, seed: int, runs: Sequence[FinishedRun], bounds: Bounds) -> bool:
    partners = [(run.group, data) for run, data in runs if run.group in wanted.groups and run.seed == seed]
    everywhere = {group for group, _ in partners} == set(wanted.groups)
    return everywhere and all(data.number(wanted.quantity, bounds) is not None for _, data in partners)


def reduce(
    number: Number, runs: Sequence[FinishedRun], bounds: Bounds, partners: Mapping[int, RunData] | None = None
) -> Measured:
    """The number over these runs; a run without it is refused, left out or replaced, as ``missing`` says.

    Args:
        number: what it is of each, and how many become one.
        runs: finished.
        bounds: beyond which they have diverged.
        partners: by seed, if each number is to be divided by that of its partner.
    """
    found = [(run.label, _of_run(number, run.seed, data, bounds, partners)) for run, data in runs]
    without = tuple(label for label, value in found if value is None)
    if number.reduce in ("count", "share"):
        return Measured(_counted(number, [value for _, value in found]), len(runs), without)
    if without and number.missing == "refuse":
        more = f" and {len(without) - 1} more" if len(without) > 1 else ""
        return Measured(None, len(runs), without, f"{without[0]}{more} without {number.quantity}")
    substitute = [] if isinstance(number.missing, str) else [number.missing] * len(without)
    values = np.array([value for _, value in found if value is not None] + substitute)
    if values.size == 0 and number.reduce not in OF_NONE:
        return Measured(None, len(runs), without, f"no run has {number.quantity}")
    estimate = REDUCTIONS[number.reduce](values) if number.reduce else exact(float(values[0]))
    if not np.isfinite(estimate.value):
        return Measured(None, len(runs), without, f"{number.reduce} of {number.quantity} overflows")
    if number.reduce == "sum" and number.metric in OUTCOMES:
        estimate = replace(estimate, of=len(runs))
    return Measured(estimate, len(runs), without)


def _of_run(
    number: Number, seed: int, data: RunData, bounds: Bounds, partners: Mapping[int, RunData] | None
) -> float | None:
    value = data.number(number.quantity, bounds)
    if partners is None or value is None:
        return value
    other = partners[seed].number(number.quantity, bounds) if seed in partners else None
    return value / other if other else None


def _counted(number: Number, values: Sequence[float | None]) -> Estimate:
    """How many runs have the number, within a bound if one is given, or of an outcome how many have come to it."""
    bound = inf if number.within is None else number.within
    count = sum(value is not None and value <= bound for value in values)
    if number.reduce == "count" or not values:
        return replace(exact(float(count)), of=len(values))
    if number.metric in OUTCOMES:
        count = sum(bool(value) and value <= bound for value in values if value is not None)
    return share_of(count, len(values))
