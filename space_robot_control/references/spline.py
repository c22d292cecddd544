"""A smooth curve through points in time: quintic pieces that agree to the fourth derivative, at rest at both ends."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import cast

import numpy as np

from space_robot_description.kernel.linear import solve
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times


class RestToRestSpline:
    """C4 quintic spline with velocity and acceleration zero at both ends.

    A cubic spline would be C2 between the points but jump in acceleration where it leaves and meets rest; with quintic
    pieces the whole motion, the rest before and after it included, is C2.

    Args:
        times: (m,) increasing, m at least 2 [s].
        points: (m, k) what to pass through.

    Reference: quintic Hermite pieces; the continuity of the third and fourth derivative at the inner points is one
    linear system for the velocities and accelerations there (de Boor, "A Practical Guide to Splines", 2001, ch. IV).
    """

    def __init__(self, times: Sequence[float], points: Vector) -> None:
        self._times = [float(time) for time in times]
        spans = np.diff(self._times)
        v, a = _inner_derivatives(spans, points)
        self._spans = spans.tolist()
        self._pieces = [
            quintic_piece(points[i : i + 2], h * v[i : i + 2], h * h * a[i : i + 2]) for i, h in enumerate(self._spans)
        ]

    def at(self, time: float) -> list[list[float]]:
        """Return value, first and second derivative (k,) at a time within the spline [s]."""
        i = min(max(bisect_right(self._times, time) - 1, 0), len(self._pieces) - 1)
        h = self._spans[i]
        return piece_at(self._pieces[i], (time - self._times[i]) / h, h)

    def bounds(self) -> tuple[Vector, Vector]:
        """Return the smallest and the largest value (k,) over the whole spline."""
        values = []
        for piece in self._pieces:
            for column in piece.T:
                slope = column[:0:-1] * np.arange(5, 0, -1)
                roots = np.roots(slope)
                turns = roots[np.isreal(roots)].real
                inside = np.concatenate(([0.0, 1.0], turns[(turns > 0.0) & (turns < 1.0)]))
                values.append([extreme(np.polyval(column[::-1], inside)) for extreme in (np.min, np.max)])
        table = np.array(values).reshape(len(self._pieces), -1, 2)
        return table[:, :, 0].min(axis=0), table[:, :, 1].max(axis=0)


def piece_at(piece: Vector, t: float, span: float) -> list[list[float]]:
    """Return value, first and second derivative (k,) of a polynomial piece.

    Args:
        piece: (6, k) coefficients in normalised time.
        t: normalised time in [0, 1].
        span: duration of the piece [s].
    """
    t2, t3 = t * t, t * t * t
    powers = (
        (1.0, t, t2, t3, t2 * t2, t2 * t3),
        (0.0, 1.0 / span, 2.0 * t / span, 3.0 * t2 / span, 4.0 * t3 / span, 5.0 * t2 * t2 / span),
        (0.0, 0.0, 2.0 / (span * span), 6.0 * t / (span * span), 12.0 * t2 / (span * span), 20.0 * t3 / (span * span)),
    )
    return cast("list[list[float]]", times(np.array(powers), piece).tolist())


def _inner_derivatives(spans: Vector, points: Vector) -> tuple[Vector, Vector]:
    """Velocities and accelerations (m, k) at the points, zero at both ends.

    With d = x1 - x0 of a piece of length h, the third derivative at its start and its end is
    60 d/h^3 - (36 v0 + 24 v1)/h^2 + (3 a1 - 9 a0)/h and 60 d/h^3 - (24 v0 + 36 v1)/h^2 + (9 a1 - 3 a0)/h;
    the fourth is -360 d/h^4 + (192 v0 + 168 v1)/h^3 + (36 a0 - 24 a1)/h^2 and
    360 d/h^4 - (168 v0 + 192 v1)/h^3 + (36 a1 - 24 a0)/h^2.
    """
    m, k = points.shape
    system, right = np.zeros((2 * m, 2 * m)), np.zeros((2 * m, k))
    for i in range(1, m - 1):
        g, h = spans[i - 1], spans[i]
        g2, h2 = g * g, h * h
        back, ahead = points[i] - points[i - 1], points[i + 1] - points[i]
        third, fourth = system[2 * i], system[2 * i + 1]
        # Columns are v, a of the points i-1, i, i+1; each row is (end of the piece before) - (start of the next) = 0.
        third[2 * i - 2 : 2 * i + 4] = (
            *(-24.0 / g2, -3.0 / g),
            *(-36.0 / g2 + 36.0 / h2, 9.0 / g + 9.0 / h),
            *(24.0 / h2, -3.0 / h),
        )
        right[2 * i] = 60.0 * (ahead / (h2 * h) - back / (g2 * g))
        fourth[2 * i - 2 : 2 * i + 4] = (
            *(-168.0 / (g2 * g), -24.0 / g2),
            *(-192.0 / (g2 * g) - 192.0 / (h2 * h), 36.0 / g2 - 36.0 / h2),
            *(-168.0 / (h2 * h), 24.0 / h2),
        )
        right[2 * i + 1] = -360.0 * (ahead / (h2 * h2) + back / (g2 * g2))
    for row in (0, 1, 2 * m - 2, 2 * m - 1):
        system[row, row] = 1.0
    solution = solve(system, right)
    return solution[::2], solution[1::2]


def quintic_piece(x: Vector, v: Vector, a: Vector) -> Vector:
    """Return coefficients (6, k) in normalised time from value, h v and h^2 a at both ends (2, k)."""
    d = x[1] - x[0]
    return np.array(
        (
            x[0],
            v[0],
            0.5 * a[0],
            10.0 * d - 6.0 * v[0] - 4.0 * v[1] - 1.5 * a[0] + 0.5 * a[1],
            -15.0 * d + 8.0 * v[0] + 7.0 * v[1] + 1.5 * a[0] - a[1],
            6.0 * d - 3.0 * v[0] - 3.0 * v[1] - 0.5 * a[0] + 0.5 * a[1],
        )
    )
