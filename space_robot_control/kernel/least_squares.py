"""One update of recursive least squares on a square root of the covariance, row by row.

Reference: Potter 1963, in Battin, Astronautical Guidance, 1964, sec. 9.5; Bierman, Factorization Methods for Discrete
Sequential Estimation, 1977, sec. II.3.
"""

from __future__ import annotations

from math import sqrt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


@kernel
def learn(
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
        variance = _look_along(root, rows[i], along)
        residual = values[i] - dot_product(rows[i], estimate)
        _shrink(root, along, 1.0 / (variance + sqrt(variance)), lift)
        surprise += residual * residual / variance
        total += variance
        for j in range(estimate.shape[0]):
            estimate[j] += lift[j] * (residual / variance)
    return surprise, _squares(root), total


@inner
def _look_along(root: Vector, row: Vector, along: Vector) -> float:
    """Write f = L^T y; returns 1 + f . f."""
    for j in range(along.shape[0]):
        along[j] = 0.0
    for k in range(row.shape[0]):
        weight = row[k]
        # Most rows of an arm are empty for the bodies before their joint.
        if weight != 0.0:
            for j in range(along.shape[0]):
                along[j] += weight * root[k, j]
    variance = 1.0
    for j in range(along.shape[0]):
        variance += along[j] * along[j]
    return variance


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
def _squares(root: Vector) -> float:
    total = 0.0
    for k in range(root.shape[0]):
        total += dot_product(root[k], root[k])
    return total


@inner
def dot_product(a: Vector, b: Vector) -> float:
    """A . b in four partial sums, which need not wait for each other."""
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    quarters = a.shape[0] // 4
    for i in range(quarters):
        k = 4 * i
        s0 += a[k] * b[k]
        s1 += a[k + 1] * b[k + 1]
        s2 += a[k + 2] * b[k + 2]
        s3 += a[k + 3] * b[k + 3]
    for k in range(4 * quarters, a.shape[0]):
        s0 += a[k] * b[k]
    return (s0 + s1) + (s2 + s3)
