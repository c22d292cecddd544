"""Recursive least squares against the batch solution, and what makes it forget."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.adaptive.least_squares import RecursiveLeastSquares
from space_robot_msgs_py.errors import ControlError

SIZE, ROWS, PERIODS = 30, 7, 40


def problem(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """A prior, its spread and the rows of 40 periods."""
    data = [(rng.normal(size=(ROWS, SIZE)), rng.normal(size=ROWS)) for _ in range(PERIODS)]
    return rng.normal(size=SIZE), rng.uniform(0.1, 2.0, SIZE), data


@pytest.mark.parametrize("seed", range(5))
def test_recursive_equals_batch_least_squares_on_the_same_rows(seed: int) -> None:
    """The estimate is the minimiser of all residuals and of the distance to the prior; the covariance its inverse."""
    prior, spread, data = problem(np.random.default_rng(seed))
    rls, estimate = RecursiveLeastSquares(spread, np.inf, 1), prior
    for rows, values in data:
        estimate, _ = rls.correct(estimate, rows, values)
    stacked = np.vstack([np.diag(1.0 / spread), *(rows for rows, _ in data)])
    batch = np.linalg.lstsq(stacked, np.concatenate([prior / spread, *(values for _, values in data)]), rcond=None)[0]
    assert np.abs(estimate - batch).max() < 1e-12
    assert np.abs(rls.covariance - np.linalg.inv(stacked.T @ stacked)).max() < 1e-13
    assert rls.covariance_trace == pytest.approx(np.trace(rls.covariance), rel=1e-12)


def test_unexcited_directions_keep_their_prior() -> None:
    """Directions that no row contains keep estimate and spread to the bit, and nothing winds up."""
    rng = np.random.default_rng(1)
    rls, estimate = RecursiveLeastSquares(np.ones(SIZE), np.inf, 1), np.ones(SIZE)
    for _ in range(2000):
        rows = rng.normal(size=(ROWS, SIZE))
        rows[:, 20:] = 0.0
        estimate, _ = rls.correct(estimate, rows, rows[:, :20] @ np.full(20, 3.0))
    assert estimate[:20] == pytest.approx(np.full(20, 3.0), abs=1e-3)
    assert (estimate[20:] == 1.0).all()
    assert rls.covariance[20:, 20:] == pytest.approx(np.eye(10), abs=0.0)


def test_the_covariance_stays_positive_over_many_accurate_rows() -> None:
    """With rows a million times as accurate as the prior no eigenvalue falls below zero."""
    rng = np.random.default_rng(2)
    rls, estimate = RecursiveLeastSquares(np.ones(SIZE), np.inf, 1), np.zeros(SIZE)
    for _ in range(500):
        rows = 1e6 * rng.normal(size=(ROWS, SIZE))
        estimate, _ = rls.correct(estimate, rows, rows @ np.ones(SIZE))
    assert np.linalg.eigvalsh(rls.covariance).min() >= -1e-25
    assert estimate == pytest.approx(np.ones(SIZE), abs=1e-6)


def test_a_changed_world_resets_and_is_learned() -> None:
    """Improbable innovations in a row start the covariance anew; without the reset the new truth is not reached."""
    rng = np.random.default_rng(3)
    after = {}
    for threshold in (25.0, np.inf):
        rls, estimate = RecursiveLeastSquares(np.ones(SIZE), threshold, 2), np.zeros(SIZE)
        for period in range(400):
            rows = rng.normal(size=(ROWS, SIZE))
            truth = np.ones(SIZE) if period < 200 else np.full(SIZE, 3.0)
            estimate, _ = rls.correct(estimate, rows, rows @ truth)
            assert rls.resets == 0 or period >= 201
        after[threshold] = rls.resets, np.abs(estimate - 3.0).max()
    assert after[25.0][0] == 1
    assert after[25.0][1] < 0.02
    assert after[np.inf][0] == 0
    assert after[np.inf][1] > 0.5


def test_a_covariance_that_blows_up_is_a_named_error() -> None:
    """Rows that are not finite end in a ControlError, not in an estimate."""
    rls = RecursiveLeastSquares(np.ones(3), np.inf, 1)
    with pytest.raises(ControlError, match="covariance"), np.errstate(all="ignore"):
        rls.correct(np.zeros(3), np.full((1, 3), 1e200), np.zeros(1))
