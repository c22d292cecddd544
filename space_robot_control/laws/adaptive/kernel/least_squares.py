"""One update of recursive least squares on a square root of the covariance, row by row.

Reference: Potter 1963, in Battin, Astronautical Guidance, 1964, sec. 9.5; Bierman, Factorization Methods for Discrete
Sequential Estimation, 1977, sec. II.3.
"""

from __future__ import annotations

from math import sqrt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


@kernel
def correct(
    rows: Vector, values: Vector, root: Vector, estimate: Vector, innovation: Vector, memory: Vector
) -> tuple[float, float, float]:
    """Correct estimate (P,) and root (P, P) by rows (m, P) and values (m,) of unit noise, in place.

    Rows of independent noise may be taken one after the other: with G = L L^T, f = L^T y and s = 1 + f . f,

        pi <- pi + L f (value - y . pi) / s,    L <- L - L f f^T / (s + sqrt(s)).

    Args:
        rows: (m, P) regressor.
        values: (m,) measurements.
        root: (P, P) L.
        estimate: (P,) pi.
        innovation: (m,) receives values - Y pi of the estimate before.
        memory: (2, P) scratch.

    Returns:
        The squared innovations over their variances, summed; the trace of G; the sum of the s.
    """
    along, lift = memory[0], memory[1]
    surprise, total = 0.0, 0.0
    for i in range(rows.shape[0]):
        innovation[i] = values[i] - dot_product(rows[i], estimate)
    for i in range(rows.shape[0]):
        transpose_times(root, rows[i], along)
        variance = 1.0 + dot_product(along, along)
        residual = values[i] - dot_product(rows[i], estimate)
        _shrink(root, along, 1.0 / (variance + sqrt(variance)), lift)
        surprise += residual * residual / variance
        total += variance
        for j in range(estimate.shape[0]):
            estimate[j] += lift[j] * (residual / variance)
    return surprise, _squares(root, lift), total


@kernel
def transpose_times(rows: Vector, weights: Vector, out: Vector) -> None:
    """Write the sum (P,) of rows (m, P) times their weights (m,)."""
    for j in range(out.shape[0]):
        out[j] = 0.0
    for k in range(rows.shape[0]):
        # A row of an arm has nothing on the bodies before its joint.
        if weights[k] != 0.0:
            for j in range(out.shape[0]):
                out[j] += weights[k] * rows[k, j]


@kernel
def covariance_times(root: Vector, direction: Vector, along: Vector, out: Vector) -> None:
    """Write G d (P,) of G = L L^T without forming G; along (P,) is scratch."""
    transpose_times(root, direction, along)
    for k in range(root.shape[0]):
        out[k] = dot_product(root[k], along)


@inner
def _shrink(root: Vector, along: Vector, gain: float, lift: Vector) -> None:
    """Write L f, and L <- L - gain L f f^T."""
    for k in range(root.shape[0]):
        row = root[k]
        lift[k] = dot_product(row, along)
        weight = gain * lift[k]
        for j in range(along.shape[0]):
            row[j] -= weight * along[j]


@inner
def _squares(root: Vector, sums: Vector) -> float:
    """Sum of the squares of a matrix, column by column, which takes a quarter of the time of row by row."""
    for j in range(sums.shape[0]):
        sums[j] = 0.0
    for k in range(root.shape[0]):
        for j in range(sums.shape[0]):
            sums[j] += root[k, j] * root[k, j]
    total = 0.0
    for value in sums:
        total += value
    return total


@inner
def dot_product(a: Vector, b: Vector) -> float:
    """A . b in eight sums, which vector registers of any width take side by side without another order."""
    s0, s1, s2, s3, s4, s5, s6, s7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    whole = a.shape[0] - a.shape[0] % 8
    for i in range(0, whole, 8):
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
        s4 += a[i + 4] * b[i + 4]
        s5 += a[i + 5] * b[i + 5]
        s6 += a[i + 6] * b[i + 6]
        s7 += a[i + 7] * b[i + 7]
    for i in range(whole, a.shape[0]):
        s0 += a[i] * b[i]
    total: float = ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))
    return total
