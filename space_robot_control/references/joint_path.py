"""Joints through points in time, interpolated as joint_trajectory_controller of ros2_control does it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from space_robot_control.references.spline import piece_at, quintic_piece
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector

# Positions that are computed together.
CHUNK = 4096
JointMotion = tuple[list[float], list[float], list[float]]


@dataclass(frozen=True, eq=False, slots=True)
class JointPoint:
    """Where the joints are to be at a time.

    Attributes:
        time: [ns].
        position: (n,) [rad or m].
        velocity: (n,) [rad/s or m/s]; None: not said.
        acceleration: (n,) [rad/s2 or m/s2]; None: not said.
    """

    time: int
    position: Vector
    velocity: Vector | None = None
    acceleration: Vector | None = None


class JointPath:
    """From point to point; at rest in the last one from its time on.

    A piece is quintic where both its ends have velocity and acceleration, cubic where both have a velocity, else
    linear.

    Args:
        points: times increasing, at least one.

    Attributes:
        end: time of the last point [ns].

    Reference: ros2_controllers 4, joint_trajectory_controller, "Trajectory representation".
    """

    def __init__(self, points: Sequence[JointPoint]) -> None:
        self._times = [point.time for point in points]
        self._pieces = [_piece(first, last) for first, last in pairwise(points)]
        self._last = points[-1].position.tolist()
        self._table: Vector = np.array(self._pieces).reshape(len(self._pieces), 6, len(self._last))
        self._still = [0.0] * len(self._last)
        self.end = self._times[-1]

    def at(self, stamp: int) -> JointMotion:
        """Return position, velocity and acceleration, n each, at a stamp not before the first point [ns]."""
        if stamp >= self.end:
            return self._last, self._still, self._still
        i = max(bisect_right(self._times, stamp) - 1, 0)
        span = self._times[i + 1] - self._times[i]
        x, dx, ddx = piece_at(self._pieces[i], (stamp - self._times[i]) / span, span / NANOSECONDS)
        return x, dx, ddx

    def positions(self, stamps: Sequence[int]) -> Vector:
        """Return the positions (m, n) at stamps [ns], many at once."""
        rows = np.tile(np.array(self._last), (len(stamps), 1))
        for begin in range(0, len(stamps), CHUNK):
            some = np.array(stamps[begin : begin + CHUNK], dtype=np.int64)
            some = some[some < self.end]
            if some.size:
                times = np.array(self._times, dtype=np.int64)
                i = np.maximum(np.searchsorted(times, some, side="right") - 1, 0)
                t = (some - times[i]) / (times[i + 1] - times[i])
                powers = np.multiply.accumulate([np.ones_like(t), t, t, t, t, t]).T
                rows[begin : begin + some.size] = np.einsum("mp,mpn->mn", powers, self._table[i])
        return rows


def _piece(first: JointPoint, last: JointPoint) -> Vector:
    """Coefficients (6, n) in normalised time."""
    h, x0, d = (last.time - first.time) / NANOSECONDS, first.position, last.position - first.position
    none = np.zeros_like(d)
    if first.velocity is None or last.velocity is None:
        return np.array((x0, d, none, none, none, none))
    v0, v1 = h * first.velocity, h * last.velocity
    if first.acceleration is None or last.acceleration is None:
        return np.array((x0, v0, 3.0 * d - 2.0 * v0 - v1, v0 + v1 - 2.0 * d, none, none))
    ends = np.array((first.position, last.position))
    return quintic_piece(ends, np.array((v0, v1)), h * h * np.array((first.acceleration, last.acceleration)))
