"""Forces of the nominal robot's actuators for a motion: the text of ``NominalModel`` for kernels."""

from __future__ import annotations

import math

from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.inverse_dynamics import inverse_dynamics
from space_robot_description.kernel.jit import inner
from space_robot_description.kernel.quaternion import put, three
from space_robot_description.kernel.spatial import add, cross
from space_robot_msgs_py.interfaces import Vector


@inner
def actuated_forces(
    robot: RobotArrays, mass: float, floating: int, q: Vector, v: Vector, a: Vector, work: Vector, u: Vector
) -> bool:
    """Write u = M a + c; of a free-floating robot with the translation of zero force, also into a. False: not finite.

    Args:
        robot: the nominal robot.
        mass: of all bodies [kg].
        floating: 1: no force acts on the base.
        q: (7+n,) configuration.
        v: (6+n,) velocity.
        a: (6+n,) desired derivative of v.
        work: (1+n, MOTION_SIZE) scratch.
        u: (6+n,) written.
    """
    if floating:
        a[0], a[1], a[2] = 0.0, 0.0, 0.0
        inverse_dynamics(robot, q, v, a, work, u)
        a[0], a[1], a[2] = u[0] / -mass, u[1] / -mass, u[2] / -mass
    inverse_dynamics(robot, q, v, a, work, u)
    total = 0.0
    for i in range(u.shape[0]):
        total += u[i]
    if floating:
        u[0], u[1], u[2] = 0.0, 0.0, 0.0
    return math.isfinite(total)


@inner
def add_gyroscopic(wheels: Vector, v: Vector, u: Vector) -> None:
    """Add omega x h of the wheels' momentum (3,) to u (6+n,)."""
    put(u, 3, add(three(u, 3), cross(three(v, 3), three(wheels, 0))))


@inner
def sum_of_squares(v: Vector, first: int) -> float:
    """Sum of the squares from an entry on."""
    total = 0.0
    for i in range(first, v.shape[0]):
        total += v[i] * v[i]
    return total
