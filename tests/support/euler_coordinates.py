"""Euler coordinates of the adaptive law for tests that say its equations again."""

from __future__ import annotations

from math import remainder, tau

import numpy as np

from space_robot_control.laws.adaptive.euler_coordinates import ROLL, YAW
from space_robot_control.laws.adaptive.kernel.euler import second_derivative
from space_robot_msgs_py.interfaces import Reference, Vector


def euler_acceleration(reference: Reference, x: Vector, dx: Vector) -> Vector:
    """Return x'' (6+n,) of a reference whose x and x' are known [m/s2, rad/s2]."""
    ddx = np.empty(x.size)
    second_derivative(reference.q, reference.v, reference.a, x, dx, ddx)
    return ddx


def difference(to: Vector, start: Vector) -> Vector:
    """The way from start to an end (6+n,), yaw and roll within half a turn [m, rad]."""
    out: Vector = to - start
    out[YAW], out[ROLL] = remainder(out[YAW], tau), remainder(out[ROLL], tau)
    return out
