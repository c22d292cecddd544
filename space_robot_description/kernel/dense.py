"""Small dense matrices with sums of one order: equal bits on every processor, which BLAS does not promise."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import called, inner, kernel
from space_robot_msgs_py.interfaces import Vector

# Of one-sided Jacobi; it converges quadratically, so that a handful is enough for any matrix.
MAX_SWEEPS = 60
EPSILON = float(np.finfo(np.float64).eps)


@kernel
def factor(a: Vector, pivots: npt.NDArray[np.int64]) -> bool:
    """Replace a (m, m) by its LU factors with row pivoting; False: it has no inverse.

    Args:
        a: overwritten.
        pivots: (m,) integers written: the row that each one was exchanged with.
    """
    size = a.shape[0]
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        pivots[k] = best
        for j in range(size):
            a[k, j], a[best, j] = a[best, j], a[k, j]
        if a[k, k] == 0.0:
            return False
        for i in range(k + 1, size):
            a[i, k] /= a[k, k]
            for j in range(k + 1, size):
                a[i, j] -= a[i, k] * a[k, j]
    return True


@kernel
def solve(factors: Vector, pivots: npt.NDArray[np.int64], b: Vector) -> None:
    """Replace b (m,) by the x of a x = b, with the factors of a."""
    size = factors.shape[0]
    for k in range(size):
        other = pivots[k]
        b[k], b[other] = b[other], b[k]
        for j in range(k):
            b[k] -= factors[k, j] * b[j]
    for k in range(size - 1, -1, -1):
        for j in range(k + 1, size):
            b[k] -= factors[k, j] * b[j]
        b[k] /= factors[k, k]


@kernel
def excess_of(a: Vector, least: float, work: Vector) -> float:
    """Return least^2 - s^2 of the smallest singular value s of a (m, m) where s < least, else 0.

    Args:
        a: the matrix.
        least: lower bound of s.
        work: (m, m) overwritten.
    """
    if _surely_above(a, least, work):
        return 0.0
    smallest = smallest_singular_value(a, work)
    return least * least - smallest * smallest if smallest < least else 0.0


@kernel
def smallest_singular_value(a: Vector, work: Vector) -> float:
    """Return the smallest singular value of a (m, m) by one-sided Jacobi; ``work`` (m, m) is overwritten.

    Reference: Demmel and Veselic, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. 13(4), 1992.
    """
    _turn(a, work)
    smallest = dot_product(work[0], work[0])
    for i in range(1, a.shape[0]):
        smallest = min(smallest, dot_product(work[i], work[i]))
    return math.sqrt(smallest)


@kernel
def largest_singular_value(a: Vector, work: Vector) -> float:
    """Return the largest singular value of a (m, m), which of a positive definite one is its largest eigenvalue."""
    _turn(a, work)
    largest = 0.0
    for i in range(a.shape[0]):
        largest = max(largest, dot_product(work[i], work[i]))
    return math.sqrt(largest)


@called
def _turn(a: Vector, work: Vector) -> None:
    """Write the columns of a as rows of ``work``, turned until all are at right angles."""
    size = a.shape[0]
    for i in range(size):
        for j in range(size):
            work[i, j] = a[j, i]
    turned, sweeps = True, 0
    while turned and sweeps < MAX_SWEEPS:
        turned, sweeps = False, sweeps + 1
        for i in range(size):
            for j in range(i + 1, size):
                turned = _orthogonal(work[i], work[j]) or turned


@inner
def _orthogonal(x: Vector, y: Vector) -> bool:
    """Turn two rows in their plane until they are at right angles; False: they were."""
    xx, yy, xy = dot_product(x, x), dot_product(y, y), dot_product(x, y)
    if not abs(xy) > EPSILON * math.sqrt(xx * yy):
        return False
    ratio = (yy - xx) / (2.0 * xy)
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
    c = 1.0 / math.sqrt(1.0 + tangent * tangent)
    s = c * tangent
    for k in range(x.shape[0]):
        x[k], y[k] = c * x[k] - s * y[k], s * x[k] + c * y[k]
    return True


@called
def _surely_above(a: Vector, least: float, work: Vector) -> bool:
    """True only if the smallest singular value is above a bound: a^T a - bound^2 has a Cholesky factor."""
    size, trace = a.shape[0], 0.0
    for i in range(size):
        for j in range(i + 1):
            total = 0.0
            for k in range(size):
                total += a[k, i] * a[k, j]
            work[i, j] = total
        trace += work[i, i]
    # More than what rounding makes of the differences below.
    shift = least * least + 100.0 * size * EPSILON * trace
    for j in range(size):
        pivot = work[j, j] - shift
        for k in range(j):
            pivot -= work[j, k] * work[j, k]
        if not pivot > 0.0:
            return False
        work[j, j] = math.sqrt(pivot)
        for i in range(j + 1, size):
            for k in range(j):
                work[i, j] -= work[i, k] * work[j, k]
            work[i, j] /= work[j, j]
    return True


@inner
def dot_product(x: Vector, y: Vector) -> float:
    """X . y, summed from the first entry on."""
    total = 0.0
    for k in range(x.shape[0]):
        total += x[k] * y[k]
    return total


@kernel
def diagonalise(a: Vector, vectors: Vector) -> None:
    """Make a symmetric a (m, m) diagonal, a = V diag V^T: its eigenvalues, and V (m, m) of their vectors as columns.

    Reference: Golub and Van Loan, "Matrix Computations", 2013, sec. 8.5 (cyclic Jacobi).
    """
    size = a.shape[0]
    for i in range(size):
        for j in range(size):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(MAX_SWEEPS):
        turned = False
        for p in range(size):
            for q in range(p + 1, size):
                if abs(a[p, q]) > 0.1 * EPSILON * math.sqrt(abs(a[p, p] * a[q, q])) and a[p, q] != 0.0:
                    _turn_axes(a, vectors, p, q)
                    turned = True
        if not turned:
            return


@called
def _turn_axes(a: Vector, vectors: Vector, p: int, q: int) -> None:
    """Make a[p, q] zero by a turn in the plane of both."""
    ratio = 0.5 * (a[q, q] - a[p, p]) / a[p, q]
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
    c = 1.0 / math.sqrt(1.0 + tangent * tangent)
    s = tangent * c
    for k in range(a.shape[0]):
        a[k, p], a[k, q] = c * a[k, p] - s * a[k, q], s * a[k, p] + c * a[k, q]
    for k in range(a.shape[0]):
        a[p, k], a[q, k] = c * a[p, k] - s * a[q, k], s * a[p, k] + c * a[q, k]
        vectors[k, p], vectors[k, q] = c * vectors[k, p] - s * vectors[k, q], s * vectors[k, p] + c * vectors[k, q]
    a[p, q] = a[q, p] = 0.0
