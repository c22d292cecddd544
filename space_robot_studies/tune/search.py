"""Where the search looks next: spread over the whole box first, then closer and closer around the best.

CMA-ES (Hansen and Ostermeier, Evol. Comput. 9, 2001) of the package `cmaes`: it has a generator of its own, sees only
the order of its candidates, and works by batches, so that neither the number of workers nor the order in
which runs end can change it. A search that goes on is the same search from its beginning with what is known of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from cmaes import CMA

from space_robot_msgs_py.interfaces import Vector

# First candidates per gain, and besides; independent of the budget, so that a larger one only adds candidates.
SPREAD, LEAST = 3, 3
# First step of the second part, in shares of the ranges.
SIGMA = 0.15
Rank = tuple[float, ...]


class Search:
    """Candidates in the unit cube, batch after batch.

    Args:
        dimensions: number of gains.
        budget: number of candidates.
        seed: two searches with the same one and the same ranks are the same.
    """

    def __init__(self, dimensions: int, budget: int, seed: np.random.SeedSequence) -> None:
        self._dimensions, self._left = dimensions, budget
        rng = np.random.default_rng(seed)
        self._first: list[Vector] = list(latin_hypercube(LEAST + SPREAD * dimensions, dimensions, rng))
        # 0 would be the clock.
        self._seed = 1 + int(rng.integers(2**31 - 2))
        self._known: list[tuple[Rank, int, Vector]] = []
        self._optimiser: CMA | None = None

    def ask(self) -> list[Vector]:
        """The next candidates, each (dimensions,) in 0 to 1; empty where the budget is used up."""
        if not self._dimensions or not self._left:
            return []
        if self._first:
            batch, self._first = self._first[: self._left], []
        else:
            if self._optimiser is None or self._optimiser.should_stop():
                self._optimiser = self._new_optimiser()
            batch = [self._optimiser.ask() for _ in range(self._optimiser.population_size)][: self._left]
        self._left -= len(batch)
        return batch

    def tell(self, batch: Sequence[Vector], ranks: Sequence[Rank]) -> None:
        """What came of a batch: ranks that are smaller where it went better, in the order of the batch."""
        for one, rank in zip(batch, ranks, strict=True):
            self._known.append((rank, len(self._known), one))
        optimiser = self._optimiser
        if optimiser is not None and len(batch) == optimiser.population_size:
            order = sorted(range(len(batch)), key=lambda k: (ranks[k], k))
            places = {k: float(place) for place, k in enumerate(order)}
            optimiser.tell([(one, places[k]) for k, one in enumerate(batch)])

    def _new_optimiser(self) -> CMA:
        """Around the best candidate so far, with a generator of its own for every new beginning."""
        best = min(self._known, key=lambda known: known[:2])[2]
        self._seed = 1 + self._seed % (2**31 - 2)
        bounds = np.tile([0.0, 1.0], (self._dimensions, 1))
        return CMA(mean=best.copy(), sigma=SIGMA, bounds=bounds, seed=self._seed)


def latin_hypercube(count: int, dimensions: int, rng: np.random.Generator) -> Vector:
    """Points of which every number is in another one of ``count`` equal parts of 0 to 1 (McKay et al. 1979).

    Args:
        count: number of points.
        dimensions: numbers of each.
        rng: of the places.

    Returns:
        (count, dimensions).
    """
    strata = rng.permuted(np.tile(np.arange(count), (dimensions, 1)), axis=1).T
    return (strata + rng.random((count, dimensions))) / count
