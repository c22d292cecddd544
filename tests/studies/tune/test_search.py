"""The search: the same for the same seed and ranks, spread first, and it finds the bottom of a bowl."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.gain_range import GainRange
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

pytest.importorskip("cmaes")
from space_robot_studies.tune.search import LEAST, SPREAD, Search, latin_hypercube

BOTTOM = np.array([0.3, 0.8, 0.55])


def bowl(candidate: Vector) -> float:
    """Smallest at ``BOTTOM``."""
    return float((candidate - BOTTOM[: candidate.size]) ** 2 @ [1.0, 30.0, 4.0][: candidate.size])


def searched(budget: int, seed: int = 1, dimensions: int = 3) -> Vector:
    """All candidates of a search in the bowl, (budget, dimensions)."""
    search, found = Search(dimensions, budget, np.random.SeedSequence(seed)), list[Vector]()
    while batch := search.ask():
        search.tell(batch, [(bowl(one),) for one in batch])
        found += batch
    return np.array(found)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_it_uses_its_budget_within_the_box_and_finds_the_bottom(dimensions: int) -> None:
    """Exactly as many candidates as asked for, all in 0 to 1, and the best of them close to the bottom."""
    found = searched(150, dimensions=dimensions)
    assert found.shape == (150, dimensions)
    assert ((found >= 0.0) & (found <= 1.0)).all()
    assert min(map(bowl, found)) < 1e-4 < min(map(bowl, found[: LEAST + SPREAD * dimensions]))


def test_a_search_is_a_function_of_seed_and_ranks() -> None:
    """Equal seeds give equal bits, other seeds other candidates; NumPy's global generator has no part in it."""
    np.random.seed(5)  # noqa: NPY002
    first = searched(60)
    assert searched(60).tobytes() == first.tobytes()
    assert searched(60, seed=2).tobytes() != first.tobytes()
    after = np.random.random()  # noqa: NPY002
    np.random.seed(5)  # noqa: NPY002
    assert np.random.random() == after  # noqa: NPY002


@pytest.mark.parametrize("budget", [1, 2, 12, 13, 40])
def test_a_larger_budget_only_adds(budget: int) -> None:
    """The candidates of a smaller budget are the first ones of a larger one."""
    np.testing.assert_array_equal(searched(budget), searched(60)[:budget])


def test_only_the_order_of_the_ranks_counts() -> None:
    """Ranks of any scale that are in the same order lead to the same candidates; equal ones keep their order."""
    first, other = Search(2, 50, np.random.SeedSequence(3)), Search(2, 50, np.random.SeedSequence(3))
    while batch := first.ask():
        same = other.ask()
        np.testing.assert_array_equal(batch, same)
        first.tell(batch, [(0.0, bowl(one)) for one in batch])
        other.tell(same, [(0.0, 1e6 * np.expm1(bowl(one))) for one in same])


def test_every_part_of_every_range_is_looked_at_first() -> None:
    """In each dimension the first candidates lie in different equal parts of the range."""
    points = latin_hypercube(9, 4, np.random.default_rng(1))
    assert [sorted((points[:, k] * 9).astype(int)) for k in range(4)] == [list(range(9))] * 4


def test_a_law_without_gains_has_no_candidates() -> None:
    """Nothing to search ends at once."""
    assert Search(0, 10, np.random.SeedSequence(1)).ask() == []


@pytest.mark.parametrize("scale", ["log", "linear"])
def test_shares_of_a_range_go_both_ways(scale: str) -> None:
    """Value and share are inverse, monotonic, and the ends are exact; outside is the nearer end."""
    one = GainRange(0.3, 7.0, scale)  # type: ignore[arg-type]
    assert (one.at(0.0), one.at(1.0)) == (0.3, 7.0)
    shares = np.linspace(0.0, 1.0, 21)
    values = [one.at(share) for share in shares]
    assert values == sorted(values)
    np.testing.assert_allclose([one.share(value) for value in values], shares, atol=1e-12)
    assert (one.share(0.01), one.share(100.0)) == (0.0, 1.0)
    assert GainRange(0.1, 10.0).at(0.5) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("low", "high", "scale"), [(1, 1, "log"), (2, 1, "linear"), (0, 1, "log"), (0, np.inf, "linear")]
)
def test_an_empty_range_is_refused(low: float, high: float, scale: str) -> None:
    """Equal, crossed and infinite ends, and a logarithm of nothing."""
    with pytest.raises(SpecError, match="range"):
        GainRange(low, high, scale)  # type: ignore[arg-type]
