"""Solutions of small linear systems, with sums of one order: equal bits on every processor.

LAPACK, behind ``numpy.linalg``, sums as it suits the processor.
"""

from __future__ import annotations

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot, norm, times


def solve(a: Vector, b: Vector) -> Vector:
    """Return x of a x = b.

    Args:
        a: (m, m).
        b: (m,) or (m, k).

    Raises:
        numpy.linalg.LinAlgError: a has no inverse.
    """
    size, columns = a.shape[0], b.reshape(a.shape[0], -1)
    rows = np.hstack((a, columns))
    for k in range(size):
        best = k + int(np.argmax(np.abs(rows[k:, k])))
        rows[[k, best]] = rows[[best, k]]
        if rows[k, k] == 0.0:
            raise np.linalg.LinAlgError("Singular matrix")
        rows[k + 1 :, k:] -= rows[k + 1 :, k, None] / rows[k, k] * rows[k, k:]
    out = rows[:, size:]
    for k in range(size - 1, -1, -1):
        out[k] = (out[k] - np.sum(rows[k, k + 1 : size, None] * out[k + 1 :], axis=0)) / rows[k, k]
    return np.array(out.reshape(b.shape))


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
