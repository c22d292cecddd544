"""Products and solutions of small matrices, with sums of one order: equal bits on every processor.

BLAS and LAPACK, behind ``@`` and ``numpy.linalg``, sum as it suits the processor.
"""

from __future__ import annotations

import numpy as np

from space_robot_description.kernel.dense import factor
from space_robot_description.kernel.dense import solve as solve_factored
from space_robot_msgs_py.interfaces import Vector


def times(a: Vector, b: Vector) -> Vector:
    """Return a b of a (i, j) and b (j,) or (j, k), or of a stack a (m, i, j) and b (j, k)."""
    out: Vector = np.einsum("...ij,j->...i" if b.ndim == 1 else "...ij,jk->...ik", a, b)
    return out


def dot(a: Vector, b: Vector) -> float:
    """Return the sum of a_i b_i."""
    return float(np.sum(np.multiply(a, b)))


def norm(a: Vector) -> float:
    """Return the length of a vector."""
    return float(np.sqrt(dot(a, a)))


def solve(a: Vector, b: Vector) -> Vector:
    """Return x of a x = b.

    Args:
        a: (m, m).
        b: (m,) or (m, k).

    Raises:
        numpy.linalg.LinAlgError: a has no inverse.
    """
    factors, pivots = np.array(a, dtype=np.float64, order="C"), np.empty(a.shape[0], dtype=np.int64)
    if not factor(factors, pivots):
        raise np.linalg.LinAlgError("Singular matrix")
    columns = np.array(b.T, dtype=np.float64, ndmin=2, order="C")
    for column in columns:
        solve_factored(factors, pivots, column)
    return np.ascontiguousarray(columns.T).reshape(b.shape)


def inverse(a: Vector) -> Vector:
    """Return the inverse of a (m, m).

    Raises:
        numpy.linalg.LinAlgError: it has none.
    """
    return solve(a, np.identity(a.shape[0]))


def least_norm(a: Vector) -> Vector:
    """Return the (k, m) matrix that gives the least x of a x = b, for a (m, k) of independent rows.

    Raises:
        numpy.linalg.LinAlgError: the rows depend on each other.
    """
    return np.ascontiguousarray(solve(times(a, a.T), a).T)


def least_squares(a: Vector, b: Vector) -> tuple[Vector, Vector]:
    """Return the x (k,) of least |a x - b|, and the diagonal (k,) of (a^T a)^-1.

    Args:
        a: (m, k) of independent columns.
        b: (m,).

    Reference: Bjorck, "Numerical Methods for Least Squares Problems", 1996, sec. 2.4 (modified Gram-Schmidt, twice).
    """
    columns, size = np.array(a.T, order="C"), a.shape[1]
    upper, right, rest = np.zeros((size, size)), np.empty(size), np.array(b)
    for i, column in enumerate(columns):
        for j in (*range(i), *range(i)):
            part = dot(columns[j], column)
            upper[j, i] += part
            column -= part * columns[j]
        upper[i, i] = norm(column)
        column /= upper[i, i]
        right[i] = dot(column, rest)
        rest -= right[i] * column
    back = inverse(upper)
    return times(back, right), np.sum(back * back, axis=1)
