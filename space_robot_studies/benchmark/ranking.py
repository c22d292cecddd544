"""Which laws differ at a point: means with intervals, and paired tests over the same held-out draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.reproduce.estimate import Estimate, bootstrap

LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class Standing:
    """One setting of a law at a point.

    Attributes:
        law: name.
        objectives: one per held-out draw; None where the run did not complete.
        draws: numbers of each draw.
    """

    law: str
    objectives: tuple[float | None, ...]
    draws: tuple[Mapping[str, Any], ...]

    @classmethod
    def of(cls, law: str, draws: Sequence[Mapping[str, Any]]) -> Standing:
        """Of the draws of a row."""
        return cls(law, tuple(draw["objective"] for draw in draws), tuple(draws))

    @property
    def whole(self) -> bool:
        """Every run completed and kept the constraints."""
        return all(draw["objective"] is not None and not draw["excess"] for draw in self.draws)

    @property
    def settled(self) -> int:
        """Runs of which every axis with a band settled."""
        return sum(draw["settling_time"] is not None for draw in self.draws)

    def mean(self, name: str) -> Estimate | None:
        """Mean of a number with its 95 % bootstrap interval; None where a draw does not have it."""
        values = [draw[name] for draw in self.draws]
        return None if None in values else bootstrap(np.array(values), np.mean)


@dataclass(frozen=True, slots=True)
class Ranking:
    """What may be said of a point.

    Attributes:
        best: law of the least mean objective among those that completed every draw; None where none did.
        equal: laws that are not separated from it.
        worse: law to the mean difference to the best, where the paired test and its interval separate them.
        failed: laws that did not complete every draw within the constraints.
    """

    best: str | None
    equal: tuple[str, ...] = ()
    worse: Mapping[str, Estimate] | None = None
    failed: tuple[str, ...] = ()


def rank(standings: Sequence[Standing]) -> Ranking:
    """Compare every law with the best one in pairs: Wilcoxon's signed-rank test, Holm's correction, 5 % in all.

    A difference is stated where the test rejects and the 95 % interval of the mean difference is above zero.
    """
    whole = [one for one in standings if one.whole]
    failed = tuple(one.law for one in standings if not one.whole)
    if not whole:
        return Ranking(None, failed=failed)
    best, *others = sorted(whole, key=lambda one: (float(np.mean(_values(one))), one.law))
    found = compared({one.law: _values(one) - _values(best) for one in others})
    worse = {law: one.mean for law, one in found.items() if one.apart and one.mean.low > 0.0}
    equal = tuple(one.law for one in others if one.law not in worse)
    return Ranking(best.law, equal, worse, failed)


class Difference(NamedTuple):
    """Of pairs.

    Attributes:
        mean: of the differences with its 95 % interval.
        apart: the paired test and the interval both separate it from zero.
    """

    mean: Estimate
    apart: bool


def compared(pairs: Mapping[str, Vector]) -> dict[str, Difference]:
    """Which of some differences are none of chance, at 5 % for all of them together.

    Args:
        pairs: name to a difference per pair.

    Returns:
        Name to its difference, the surest first.
    """
    tests = sorted((_p_value(differences), name) for name, differences in pairs.items())
    found: dict[str, Difference] = {}
    rejected = True
    for place, (p, name) in enumerate(tests):
        # Holm: the first that is not rejected ends the list.
        rejected = rejected and p * (len(tests) - place) <= LEVEL
        mean = bootstrap(pairs[name], np.mean)
        found[name] = Difference(mean, rejected and not mean.low <= 0.0 <= mean.high)
    return found


def differences(worse: Standing, better: Standing) -> Vector | None:
    """Objective of one less that of the other, draw by draw; None where a run did not complete or misses a constraint.

    Args:
        worse: on the same draws as
        better: this one.
    """
    return _values(worse) - _values(better) if worse.whole and better.whole else None


def _values(one: Standing) -> Vector:
    return np.array(one.objectives, dtype=np.float64)


def _p_value(differences: Any) -> float:
    """Of Wilcoxon's signed-rank test; 1 where all pairs are equal."""
    if not differences.any():
        return 1.0
    # Only here: SciPy's statistics take a second to load.
    from scipy.stats import wilcoxon

    return float(wilcoxon(differences).pvalue)
