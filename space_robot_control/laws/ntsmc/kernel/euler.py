"""Roll, pitch, yaw without jumps and their rates, for the Euler law: the text of ``angle_branch`` for kernels."""

from __future__ import annotations

from math import copysign, pi, sqrt, tau

import numpy as np

from space_robot_description.kernel.jit import inner
from space_robot_description.kernel.quaternion import Quat
from space_robot_description.kernel.spatial import Vec
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2, cos, sincos

# [-]: at a |cos pitch| below this, roll and yaw cannot be separated in a quaternion of doubles.
LOCKED = 1e-7


@inner
def wrapped(angle: float) -> float:
    """The angle in [-pi, pi] that differs by whole turns, without rounding [rad]."""
    rest = float(np.fmod(angle, tau))
    return rest - tau if rest > pi else rest + tau if rest < -pi else rest


@inner
def to_rpy(q: Quat) -> Vec:
    """Roll, pitch, yaw of a unit quaternion [rad]; see ``rotations.to_rpy``."""
    x, y, z, w = q
    difference, half_sum = atan2(x - z, w + y), atan2(x + z, w - y)
    across, along = sqrt((w + y) * (w + y) + (x - z) * (x - z)), sqrt((w - y) * (w - y) + (x + z) * (x + z))
    pitch = 2.0 * atan2(across, along) - 0.5 * pi
    return wrapped(half_sum + difference), pitch, wrapped(half_sum - difference)


@inner
def nearest(q: Quat, last: Vector) -> Vec:
    """The triplet of an attitude that is nearest to the one before [rad], see ``AngleBranch``."""
    roll, pitch, yaw = to_rpy(q)
    if cos(pitch) < LOCKED:
        sign = copysign(1.0, pitch)
        roll, yaw = roll - sign * (yaw - last[2]), last[2]
    first = _moved((roll, pitch, yaw), last)
    second = _moved((roll + pi, pi - pitch, yaw + pi), last)
    return first if _distance(first, last) <= _distance(second, last) else second


@inner
def euler_rates(rpy: Vec, omega: Vec, min_cosine: float) -> Vec:
    """Derivatives of roll, pitch, yaw for a body rate: N(rpy)^-1 omega [rad/s]."""
    (sr, cr), (sp, cp) = sincos(rpy[0]), sincos(rpy[1])
    if abs(cp) < min_cosine:
        cp = copysign(min_cosine, cp)
    yaw_rate = (sr * omega[1] + cr * omega[2]) / cp
    return omega[0] + yaw_rate * sp, cr * omega[1] - sr * omega[2], yaw_rate


@inner
def body_acceleration(rpy: Vec, rates: Vec, accelerations: Vec) -> Vec:
    """N rpy'' + N' rpy' [rad/s2]; see ``rotations.rpy_rates``."""
    (sr, cr), (sp, cp) = sincos(rpy[0]), sincos(rpy[1])
    dr, dp, dy = rates
    ddr, ddp, ddy = accelerations
    yaw_rate, yaw_acceleration = dy * cp, ddy * cp - dy * dp * sp
    wy, wz = dp * cr + yaw_rate * sr, yaw_rate * cr - dp * sr
    return (
        ddr - ddy * sp - dy * dp * cp,
        ddp * cr + yaw_acceleration * sr + dr * wz,
        yaw_acceleration * cr - ddp * sr - dr * wy,
    )


@inner
def _moved(rpy: Vec, last: Vector) -> Vec:
    return (
        last[0] + wrapped(rpy[0] - last[0]),
        last[1] + wrapped(rpy[1] - last[1]),
        last[2] + wrapped(rpy[2] - last[2]),
    )


@inner
def _distance(rpy: Vec, last: Vector) -> float:
    a, b, c = rpy[0] - last[0], rpy[1] - last[1], rpy[2] - last[2]
    squared: float = a * a + b * b + c * c
    return squared
