"""Inertia of the nominal robot at rest: products with it, and itself, by inverse dynamics."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.nominal import actuated_forces
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE
from space_robot_description.kernel.jit import called, inner
from space_robot_msgs_py.interfaces import Vector


class MassWork(NamedTuple):
    """Room for what is below, and a velocity that stays zero."""

    still: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]
    bodies: npt.NDArray[np.float64]


def mass_work(joints: int, followers: int = 0) -> MassWork:
    """Room for that many joints, and others that follow them."""
    size = 6 + joints
    return MassWork(np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((1 + joints + followers, MOTION_SIZE)))


@inner
def inertia_times(
    robot: RobotArrays, mass: float, floating: int, q: Vector, a: Vector, work: MassWork, out: Vector
) -> bool:
    """Write H a (6+n,), the forces of an acceleration at rest. False: not finite.

    Args:
        robot: the nominal robot.
        mass: of all bodies [kg].
        floating: 1: no force acts on the base, whose translation is eliminated and not looked at in ``a``.
        q: (7+n,) configuration.
        a: (6+n,) acceleration; of a floating robot its translation is overwritten.
        work: overwritten.
        out: (6+n,) written.
    """
    return actuated_forces(robot, mass, floating, q, work.still, a, work.bodies, out)


@called
def inertia(robot: RobotArrays, mass: float, floating: int, q: Vector, work: MassWork, out: Vector) -> bool:
    """Write H (m, m), of the degrees of freedom that have an actuator. False: not finite."""
    size, finite = work.still.shape[0], True
    first = size - out.shape[0]
    for j in range(first, size):
        for i in range(size):
            work.acceleration[i] = 1.0 if i == j else 0.0
        finite = inertia_times(robot, mass, floating, q, work.acceleration, work, work.force) and finite
        for i in range(first, size):
            out[i - first, j - first] = work.force[i]
    return finite
