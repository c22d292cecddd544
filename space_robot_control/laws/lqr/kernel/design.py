"""The robot linearised at rest in a posture and sampled, in shares of what is accepted of errors and efforts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import UNUSABLE
from space_robot_control.kernel.mass import MassWork, inertia
from space_robot_control.kernel.matrices import clear, divide
from space_robot_control.laws.lqr.kernel.riccati import RiccatiRoom, riccati_room, solve_riccati
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import called
from space_robot_msgs_py.interfaces import Vector


class RegulatorRule(NamedTuple):
    """The numbers of the law; by Bryson's rule errors and inputs are divided by what is accepted of them.

    Attributes:
        error: (m,) accepted errors [m, rad, rad or m].
        rate: (m,) of their rates [m/s, rad/s, rad/s or m/s].
        effort: (m,) of the inputs [N, N m].
        posture_step: motion of a joint after which K is computed again [rad or m].
        period: T [s].
        mass: of the nominal robot [kg].
        floating: 1: no force acts on the base.
        gyroscopic: 1: omega x h of the wheels is part of the command.
    """

    error: npt.NDArray[np.float64]
    rate: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    posture_step: float
    period: float
    mass: float
    floating: int
    gyroscopic: int


class DesignMemory(NamedTuple):
    """Regulator of a posture; x = [e / error, e' / rate], inputs in shares of ``effort``.

    Attributes:
        joints: (n,) posture it was made for [rad or m].
        a: (2m, 2m) x_{k+1} = a x_k + b w_k over a period in which w is held.
        b: (2m, m).
        cost: (2m, 2m) x^T cost x is what is still to come under ``gain``.
        gain: (m, 2m) w = -gain x.
        closed: (2m, 2m) a - b gain.
        inertia: (m, m) overwritten.
        inverse: (m, m) of it.
        room: of the Riccati equation.
    """

    joints: npt.NDArray[np.float64]
    a: npt.NDArray[np.float64]
    b: npt.NDArray[np.float64]
    cost: npt.NDArray[np.float64]
    gain: npt.NDArray[np.float64]
    closed: npt.NDArray[np.float64]
    inertia: npt.NDArray[np.float64]
    inverse: npt.NDArray[np.float64]
    room: RiccatiRoom


def design_memory(joints: int, inputs: int) -> DesignMemory:
    """Memory for n joints and m inputs."""
    s, m = 2 * inputs, inputs
    model = np.zeros((s, s)), np.zeros((s, m)), np.zeros((s, s)), np.zeros((m, s)), np.zeros((s, s))
    return DesignMemory(np.zeros(joints), *model, np.zeros((m, m)), np.zeros((m, m)), riccati_room(s, m))


@called
def make_design(rule: RegulatorRule, robot: RobotArrays, q: Vector, work: MassWork, design: DesignMemory) -> int:
    """Make the regulator at rest in a configuration (7+n,); returns a status, see ``solve_riccati``.

    Errors are desired minus actual: e'' = -M^-1 w, of the degrees of freedom that have an actuator.
    """
    clear(design.inverse, 1.0)
    if not inertia(robot, rule.mass, rule.floating, q, work, design.inertia):
        return UNUSABLE
    if not divide(design.inertia, design.inverse):
        return UNUSABLE
    m, T = rule.effort.shape[0], rule.period
    clear(design.a, 1.0)
    for i in range(m):
        design.a[i, m + i] = T * rule.rate[i] / rule.error[i]
        for j in range(m):
            response = design.inverse[i, j] * rule.effort[j]
            design.b[i, j] = -0.5 * T * T * response / rule.error[i]
            design.b[m + i, j] = -T * response / rule.rate[i]
    for i in range(design.joints.shape[0]):
        design.joints[i] = q[7 + i]
    status: int = solve_riccati(design.a, design.b, design.room, design.cost, design.gain, design.closed)
    return status
