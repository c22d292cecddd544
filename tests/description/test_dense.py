"""Small dense matrices of the kernels, compared with LAPACK."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_description.kernel.dense import diagonalise, excess_of, factor, smallest_singular_value, solve
from space_robot_msgs_py.interfaces import Vector


def random_matrix(seed: int) -> Vector:
    """Of one to thirteen rows, with singular values from 1 down to 1e-6 at the least."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 14))
    u, v = (np.linalg.qr(rng.normal(size=(size, size)))[0] for _ in range(2))
    return np.ascontiguousarray(u * np.geomspace(1.0, 10.0 ** rng.uniform(-6.0, 0.0), size) @ v)


@pytest.mark.parametrize("seed", range(40))
def test_systems_are_solved_as_by_lapack(seed: int) -> None:
    """The residual is a rounding error of the matrix times the solution."""
    a = random_matrix(seed)
    b, size = np.random.default_rng(seed).normal(size=len(a)), len(a)
    factors, pivots, x = a.copy(), np.zeros(size, dtype=np.int64), b.copy()
    assert factor(factors, pivots)
    solve(factors, pivots, x)
    assert np.abs(a @ x - b).max() < 1e-14 * size * np.linalg.norm(a) * np.linalg.norm(x)


def test_a_singular_matrix_has_no_factors() -> None:
    """A pivot of exactly zero is said."""
    assert not factor(np.array([[1.0, 2.0], [0.5, 1.0]]), np.zeros(2, dtype=np.int64))


@pytest.mark.parametrize("seed", range(40))
def test_the_smallest_singular_value_is_that_of_lapack(seed: int) -> None:
    """Of well and badly conditioned matrices, to rounding errors of the largest one."""
    a = random_matrix(seed)
    work = np.zeros_like(a)
    exact = np.linalg.svd(a, compute_uv=False)[-1]
    assert smallest_singular_value(a, work) == pytest.approx(exact, abs=1e-14)
    assert excess_of(a, 0.99 * exact, work) == 0.0
    assert excess_of(a, 2.0 * exact, work) == pytest.approx(3.0 * exact**2, rel=1e-7)


def test_numbers_that_are_not_finite_come_to_an_end() -> None:
    """No loop goes on for ever because nothing compares with NaN."""
    a = np.array([[np.nan, 1.0], [2.0, np.inf]])
    assert not np.isfinite(smallest_singular_value(a, np.zeros((2, 2))))


def test_a_symmetric_matrix_is_made_diagonal() -> None:
    """Eigenvalues to their last places, vectors at right angles, also of equal eigenvalues and of diagonal matrices."""
    rng = np.random.default_rng(5)
    root = rng.normal(size=(4, 4))
    for a in (root @ root.T, root + root.T, np.diag([3.0, 1.0, 1.0, 2.0]), np.zeros((4, 4))):
        left, vectors = np.array(a), np.empty((4, 4))
        diagonalise(left, vectors)
        np.testing.assert_allclose(np.sort(np.diag(left)), np.linalg.eigvalsh(a), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(vectors @ vectors.T, np.identity(4), atol=1e-14)
        np.testing.assert_allclose(vectors * np.diag(left) @ vectors.T, a, atol=1e-13)
