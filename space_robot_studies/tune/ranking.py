"""Which of two evaluations is better, and what an evaluation comes to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.reproduce.estimate import Estimate, bootstrap
from space_robot_studies.tune.search import Rank

FEASIBLE, MISSES, FAILS = 0.0, 1.0, 2.0


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Gains and what came of them.

    Attributes:
        number: in the order of the search; 0 are the shipped gains.
        gains: dotted name to value, of those that are searched; empty for the shipped ones.
        draws: what ``Judge.read`` says of each draw, in order.
        over: ``mean`` or ``worst`` of the draws.
    """

    number: int
    gains: Mapping[str, float]
    draws: tuple[Mapping[str, Any], ...]
    over: str = "mean"

    @property
    def failed(self) -> int:
        """Draws whose run did not complete."""
        return sum(draw["objective"] is None for draw in self.draws)

    @property
    def excess(self) -> float:
        """By how much the constraints are missed in the completed draws, see ``Judge.read`` [-]."""
        return float(sum(draw["excess"] or 0.0 for draw in self.draws))

    @property
    def feasible(self) -> bool:
        """Every draw completed and kept every constraint."""
        return not self.failed and self.excess == 0.0

    @property
    def objective(self) -> float | None:
        """Mean or worst of the draws; None where one did not complete."""
        if self.failed:
            return None
        values = [draw["objective"] for draw in self.draws]
        return float(max(values) if self.over == "worst" else np.mean(values))

    @property
    def estimate(self) -> Estimate | None:
        """Mean over the draws with its 95 % interval; None where one did not complete."""
        return None if self.failed else bootstrap(np.array([draw["objective"] for draw in self.draws]), np.mean)

    @property
    def rank(self) -> Rank:
        """Smaller is better: first what completes and keeps the constraints (Deb 2000), then what misses least."""
        if self.failed:
            return FAILS, float(self.failed), self.excess
        return (MISSES, self.excess, 0.0) if self.excess else (FEASIBLE, self.objective or 0.0, 0.0)

    def mean(self, name: str) -> float | None:
        """Mean of one of ``METRICS`` over the completed draws that have it."""
        values = [draw[name] for draw in self.draws if draw.get(name) is not None]
        return float(np.mean(values)) if values else None

    def numbers(self) -> dict[str, float | None]:
        """Means of all ``METRICS``."""
        return {name: self.mean(name) for name in METRICS}


def pareto(evaluations: Sequence[Evaluation], first: str, second: str) -> list[Evaluation]:
    """The feasible evaluations that no other one beats in both numbers, by the first number."""
    pairs = [(one.mean(first), one.mean(second), one) for one in evaluations if one.feasible]
    there = sorted(
        ((a, b, one) for a, b, one in pairs if a is not None and b is not None), key=lambda p: (p[0], p[1], p[2].number)
    )
    front: list[Evaluation] = []
    least = float("inf")
    for _, b, one in there:
        if b < least:
            front.append(one)
            least = b
    return front
