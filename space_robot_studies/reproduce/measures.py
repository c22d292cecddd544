"""Numbers of runs: what each run has, and how many runs become one number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.reproduce.manifest import Bounds
from space_robot_studies.reproduce.plan import PlannedRun
from space_robot_studies.reproduce.quantities import Measure, Number, Partners, Quantity
from space_robot_studies.reproduce.run_data import RunData

TAKES: dict[str, Callable[[Vector], float]] = {
    "final": lambda x: float(x[-1]),
    "max": lambda x: float(x.max()),
    "min": lambda x: float(x.min()),
    "mean": lambda x: float(x.mean()),
    "rms": lambda x: float(np.sqrt(np.mean(x**2))),
    "max_abs": lambda x: float(np.abs(x).max()),
}
REDUCTIONS: dict[str, Callable[[Vector], float]] = {
    "min": lambda x: float(x.min()),
    "max": lambda x: float(x.max()),
    "mean": lambda x: float(x.mean()),
    "median": lambda x: float(np.median(x)),
    "std": lambda x: float(x.std()),
    "sum": lambda x: float(x.sum()),
    "count": lambda x: float(x.size),
}
OF_NONE = ("sum", "count")


FinishedRun = tuple[PlannedRun, RunData]


@dataclass(frozen=True, slots=True)
class Measured:
    """A number over runs.

    Attributes:
        value: None if there is none; then ``why`` says why.
        runs: how many there are.
        without: labels of runs that lack the number.
        why: no value.
    """

    value: float | None
    runs: int
    without: tuple[str, ...] = ()
    why: str = ""


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
    return [
        run
        for run in runs
        if run.group in measure.groups
        and all(key in run.values and run.values[key] == value for key, value in measure.where.items())
    ]


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


def reduce(number: Number, runs: Sequence[FinishedRun], bounds: Bounds) -> Measured:
    """The number over these runs; a run without it is refused, left out or replaced, as ``missing`` says."""
    found = [(run.label, data.number(number.quantity, bounds)) for run, data in runs]
    without = tuple(label for label, value in found if value is None)
    if without and number.missing == "refuse":
        more = f" and {len(without) - 1} more" if len(without) > 1 else ""
        return Measured(None, len(runs), without, f"{without[0]}{more} without {number.quantity}")
    substitute = [] if isinstance(number.missing, str) else [number.missing] * len(without)
    values = np.array([value for _, value in found if value is not None] + substitute)
    if values.size == 0 and number.reduce not in OF_NONE:
        return Measured(None, len(runs), without, f"no run has {number.quantity}")
    value = REDUCTIONS[number.reduce](values) if number.reduce else float(values[0])
    if not np.isfinite(value):
        return Measured(None, len(runs), without, f"{number.reduce} of {number.quantity} overflows")
    return Measured(value, len(runs), without)
