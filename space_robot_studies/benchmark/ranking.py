"""Which laws differ at a point: means with intervals, and paired tests over the same held-out draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

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
    tests = sorted(((_p_value(_values(one) - _values(best)), one) for one in others), key=lambda t: (t[0], t[1].law))
    worse: dict[str, Estimate] = {}
    for place, (p, one) in enumerate(tests):
        difference = bootstrap(_values(one) - _values(best), np.mean)
        # Holm: the first that is not rejected ends the list.
        if p * (len(tests) - place) > LEVEL:
            break
        if difference.low > 0.0:
            worse[one.law] = difference
    equal = tuple(one.law for one in others if one.law not in worse)
    return Ranking(best.law, equal, worse, failed)


def _values(one: Standing) -> Any:
    return np.array(one.objectives, dtype=np.float64)


def _p_value(differences: Any) -> float:
    """Of Wilcoxon's signed-rank test; 1 where all pairs are equal."""
    if not differences.any():
        return 1.0
    # Only here: SciPy's statistics take a second to load.
    from scipy.stats import wilcoxon

    return float(wilcoxon(differences).pvalue)
