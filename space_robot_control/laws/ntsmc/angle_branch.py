"""Roll, pitch, yaw of a sequence of attitudes without jumps: unwrapped Euler angles."""

from __future__ import annotations

from math import copysign, pi, remainder, tau

from space_robot_description.rotations import Floats, Three, to_rpy
from space_robot_msgs_py.kernel.elementary import cos, sincos

# [-]: at a |cos pitch| below this, roll and yaw cannot be separated in a quaternion of doubles.
LOCKED = 1e-7


def wrapped(angle: float) -> float:
    """Return the angle in [-pi, pi] that differs by whole turns [rad]."""
    return remainder(angle, tau)


def euler_rates(rpy: Floats, omega: Floats, min_cosine: float) -> Three:
    """Return the derivatives of roll, pitch, yaw for a body rate: N(rpy)^-1 omega [rad/s].

    Args:
        rpy: roll, pitch, yaw [rad].
        omega: (3,) body rate [rad/s].
        min_cosine: lower bound of |cos pitch|, with its sign.
    """
    roll, pitch, _ = rpy
    wx, wy, wz = omega
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    if abs(cp) < min_cosine:
        cp = copysign(min_cosine, cp)
    yaw_rate = (sr * wy + cr * wz) / cp
    return wx + yaw_rate * sp, cr * wy - sr * wz, yaw_rate


class AngleBranch:
    """Roll, pitch, yaw of a sequence of attitudes without jumps: each the triplet nearest to the one before.

    A rotation has the triplets (r, p, y) and (r + pi, pi - p, y + pi), each angle up to whole turns. At pitch = +-90
    degrees only the difference or the sum of roll and yaw is given; yaw then stays.

    Args:
        start: (3,) angles that the first triplet is to be near [rad].
    """

    def __init__(self, start: Three) -> None:
        self._last = start

    def nearest(self, quaternion: Floats) -> Three:
        """Return the triplet of an attitude [rad], and remember it."""
        roll, pitch, yaw = to_rpy(quaternion)
        if cos(pitch) < LOCKED:
            sign = copysign(1.0, pitch)
            roll, yaw = roll - sign * (yaw - self._last[2]), self._last[2]
        triplets = [self._moved(roll, pitch, yaw), self._moved(roll + pi, pi - pitch, yaw + pi)]
        self._last = min(triplets, key=self._distance)
        return self._last

    def _moved(self, *angles: float) -> Three:
        roll, pitch, yaw = (last + wrapped(angle - last) for angle, last in zip(angles, self._last, strict=True))
        return roll, pitch, yaw

    def _distance(self, rpy: Three) -> float:
        return sum((angle - last) * (angle - last) for angle, last in zip(rpy, self._last, strict=True))
