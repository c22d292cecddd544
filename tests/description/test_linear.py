"""Solutions of small systems: those of LAPACK, but for rounding."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_description.kernel.linear import inverse, least_norm, least_squares, solve
from space_robot_msgs_py.kernel.products import dot, norm, times

RNG = np.random.default_rng(3)
A, B, C = RNG.normal(size=(9, 9)), RNG.normal(size=(9, 4)), RNG.normal(size=(12, 5))
CLOSE = {"rtol": 1e-11, "atol": 1e-13}


def test_products_and_solutions_are_those_of_numpy() -> None:
    """Of matrices, stacks and vectors, one or many right hand sides, in any order in memory."""
    np.testing.assert_allclose(times(A.T, B), A.T @ B, **CLOSE)
    np.testing.assert_allclose(times(A, B[:, 0]), A @ B[:, 0], **CLOSE)
    np.testing.assert_allclose(times(np.stack([A, A.T]), B), np.stack([A, A.T]) @ B, **CLOSE)
    np.testing.assert_allclose([dot(B[0], B[1]), norm(B[0])], [B[0] @ B[1], np.linalg.norm(B[0])], **CLOSE)
    np.testing.assert_allclose(solve(A, B), np.linalg.solve(A, B), **CLOSE)
    np.testing.assert_allclose(solve(A.T, B[:, 0]), np.linalg.solve(A.T, B[:, 0]), **CLOSE)
    np.testing.assert_allclose(inverse(A), np.linalg.inv(A), **CLOSE)
    np.testing.assert_allclose(least_norm(C.T), np.linalg.pinv(C.T), **CLOSE)


def test_arguments_stay_as_they_are() -> None:
    """Nothing is worked on in place."""
    before = A.copy(), B.copy()
    solve(A, B)
    np.testing.assert_array_equal(A, before[0])
    np.testing.assert_array_equal(B, before[1])


def test_least_squares_are_those_of_numpy() -> None:
    """Coefficients, and the diagonal of the inverse normal matrix, also of nearly dependent columns."""
    near = np.column_stack([C, C[:, 0] + 1e-6 * RNG.normal(size=12)])
    for a, digits in ((C, 1e-12), (near, 1e-8)):
        x, diagonal = least_squares(a, B[:, 0].repeat(2)[:12])
        expected = np.linalg.lstsq(a, B[:, 0].repeat(2)[:12], rcond=None)[0]
        np.testing.assert_allclose(x, expected, rtol=digits, atol=digits * np.abs(expected).max())
        np.testing.assert_allclose(diagonal, np.sum(np.linalg.pinv(a) ** 2, axis=1), rtol=1e3 * digits)


def test_a_singular_matrix_is_refused() -> None:
    """As NumPy refuses it."""
    with pytest.raises(np.linalg.LinAlgError, match="Singular"):
        solve(np.ones((3, 3)), np.ones(3))
