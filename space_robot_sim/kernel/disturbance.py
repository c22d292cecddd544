"""A force that stays in inertial space and a torque that stays in the body, on the base: drag, pressure, leftovers."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import constants, inner
from space_robot_description.kernel.quaternion import attitude, put, rotate, rotate_inverse, three
from space_robot_description.kernel.spatial import Vec, add, cross, dot
from space_robot_msgs_py.interfaces import Vector

# Entries of a disturbance: force in inertial axes, where it acts and torque, both in the body frame.
PUSH, AT, TWIST, DISTURBANCE_SIZE = constants(0, 3, 6, 9)
NOTHING: npt.NDArray[np.float64] = np.zeros(0)


@inner
def disturbance_wrench(disturbance: Vector, y: Vector) -> tuple[Vec, Vec]:
    """Force on the base and moment about its origin, body frame [N, N m], in a state y."""
    force = rotate_inverse(attitude(y), three(disturbance, PUSH))
    return force, add(cross(three(disturbance, AT), force), three(disturbance, TWIST))


@inner
def count_disturbance(disturbance: Vector, n: int, y: Vector, dy: Vector) -> None:
    """Add its power, and its force and moment about the inertial origin, to the quadratures of a state of n joints."""
    force, torque = disturbance_wrench(disturbance, y)
    q, v, omega = 13 + 2 * n, three(y, 7 + n), three(y, 10 + n)
    push = three(disturbance, PUSH)
    dy[q] += dot(force, v) + dot(torque, omega)
    put(dy, q + 1, add(three(dy, q + 1), push))
    moment = add(cross(three(y, 0), push), rotate(attitude(y), torque))
    put(dy, q + 4, add(three(dy, q + 4), moment))
