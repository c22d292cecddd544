"""What the rows add up to, with how sure that is; missing numbers are counted, never filled in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.intervals import resampled, wilson

STATISTICS = ("mean", "mean_low", "mean_high", "median", "p05", "p95", "min", "max")
RATES = ("success_rate", "completed_rate")


@dataclass(frozen=True, slots=True)
class Rate:
    """A share of the runs with its interval, see ``wilson``.

    Attributes:
        count: runs that did.
        n: all runs.
        rate: count / n [-].
        low: of the 95 % interval [-].
        high: of the 95 % interval [-].
    """

    count: int
    n: int
    rate: float
    low: float
    high: float

    @classmethod
    def of(cls, count: int, n: int) -> Rate:
        """The rate of ``count`` in ``n`` runs."""
        return cls(count, n, count / n, *wilson(count, n))


@dataclass(frozen=True, slots=True)
class Spread:
    """How one metric spreads over the completed runs, in the metric's unit; numbers are None where no run has it.

    Attributes:
        n: runs that have the number.
        missing: completed runs that have none (an axis that never settled).
        mean: with its 95 % interval ``mean_low`` to ``mean_high``, see ``resampled``; a point where nothing spreads.
        median: with the 5 % and 95 % quantiles ``p05`` and ``p95``.
        min: smallest.
        max: largest.
        worst: index of the case with the largest.
    """

    n: int
    missing: int
    mean: float | None
    mean_low: float | None
    mean_high: float | None
    median: float | None
    p05: float | None
    p95: float | None
    min: float | None
    max: float | None
    worst: int | None

    @classmethod
    def of(cls, values: Vector, indices: Sequence[int], missing: int) -> Spread:
        """The spread of the values that are there."""
        if not values.size:
            return cls(0, missing, *(None,) * (len(STATISTICS) + 1))
        low, high = resampled(values, np.mean)
        p05, median, p95 = (float(quantile) for quantile in np.quantile(values, [0.05, 0.5, 0.95]))
        worst = indices[int(np.argmax(values))]
        ends = float(np.min(values)), float(np.max(values))
        return cls(values.size, missing, float(np.mean(values)), low, high, median, p05, p95, *ends, worst)


@dataclass(frozen=True, slots=True)
class Group:
    """One point of the grid.

    Attributes:
        labels: key to label of what is varied; empty without a grid.
        success: runs that kept every bound of their experiment.
        undecided: how many of them kept what bounds there are, but nothing was expected of the task.
        completed: runs that ended by themselves.
        reasons: how the others ended, and how often.
        failed: indices of the cases that missed a bound.
        remarks: what else happened, by name, and in how many runs.
        spreads: metric to its spread over the completed runs; another robot has others.
    """

    labels: Mapping[str, Any]
    success: Rate
    undecided: int
    completed: Rate
    reasons: Mapping[str, int]
    failed: tuple[int, ...]
    remarks: Mapping[str, int]
    spreads: Mapping[str, Spread]

    def flat(self) -> dict[str, float | None]:
        """Every number under one name, e.g. ``success_rate`` or ``base/roll.overshoot.p95``: for ``expect:``."""
        numbers: dict[str, float | None] = {}
        for name, rate in zip(RATES, (self.success, self.completed), strict=True):
            numbers |= {name: rate.rate, f"{name}.low": rate.low, f"{name}.high": rate.high}
        for metric, spread in self.spreads.items():
            numbers |= {f"{metric}.{statistic}": getattr(spread, statistic) for statistic in STATISTICS}
        return numbers

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def summary_names(metrics: Sequence[str]) -> list[str]:
    """Names of ``Group.flat`` of runs with these metrics."""
    rates = [name + end for name in RATES for end in ("", ".low", ".high")]
    return rates + [f"{metric}.{statistic}" for metric in metrics for statistic in STATISTICS]


def summarise(rows: Sequence[Mapping[str, Any]], labels: Mapping[str, Any], metrics: Sequence[str]) -> Group:
    """Sum up the rows of one point of the grid.

    Args:
        rows: columns by name, at least one row.
        labels: of the point.
        metrics: names of the numbers.
    """
    completed = [row for row in rows if row["completed"]]
    spreads = {}
    for metric in metrics:
        measured = [row for row in completed if metric in row]
        held = [row for row in measured if row[metric] is not None]
        if measured:
            values, indices = np.array([row[metric] for row in held], dtype=float), [row["index"] for row in held]
            spreads[metric] = Spread.of(values, indices, len(measured) - len(held))
    return Group(
        labels=dict(labels),
        success=Rate.of(sum(row["passed"] is not False for row in rows), len(rows)),
        undecided=sum(row["passed"] is None for row in rows),
        completed=Rate.of(len(completed), len(rows)),
        reasons=dict(Counter(row["end_reason"] for row in rows if not row["completed"])),
        failed=tuple(row["index"] for row in rows if row["passed"] is False),
        remarks=dict(Counter(name for row in rows for name in (row.get("remarks") or "").split(", ") if name)),
        spreads=spreads,
    )
