"""One step of a robot that holds a body in a grasp, in free space; the equations are those of ``GraspDynamics``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix, quaternion_rate, three
from space_robot_description.kernel.spatial import Vec, add, cross, dot, mul, mul_t, sub
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.aba import forward_dynamics
from space_robot_sim.kernel.articulated import WORKSPACE
from space_robot_sim.kernel.tableau import STAGES, A, B

# Where a push has what, see ``GraspDynamics``; after these the efforts of the joint motors.
FORCE, MOMENT, TORQUE, OUTSIDE_FORCE, OUTSIDE_TORQUE, REST, TURNING, EFFORT = constants(0, 3, 6, 9, 12, 15, 16, 17)


class GraspRule(NamedTuple):
    """A grasp and the wheels, see ``GraspSpec``.

    Attributes:
        joints: (3,) of the grasp.
        stiffness: of the first two [N/m].
        damping: of the first two [N s/m].
        torsional_stiffness: of the third [N m/rad].
        torsional_damping: of the third [N m s/rad].
        slip_torque: of the third [N m].
        lag: of the wheels [s].
    """

    joints: npt.NDArray[np.int64]
    stiffness: float
    damping: float
    torsional_stiffness: float
    torsional_damping: float
    slip_torque: float
    lag: float


class GraspWork(NamedTuple):
    """Room for one step."""

    stages: npt.NDArray[np.float64]
    trial: npt.NDArray[np.float64]
    bodies: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]


def grasp_work(joints: int, size: int) -> GraspWork:
    """Room for a robot with that many joints and a state of that size."""
    bodies, effort = np.zeros((1 + joints, WORKSPACE)), np.zeros(joints)
    return GraspWork(np.zeros((STAGES, size)), np.zeros(size), bodies, effort)


@kernel
def grasp_step(robot: RobotArrays, rule: GraspRule, push: Vector, y: Vector, h: float, work: GraspWork) -> None:
    """One step of DOP853 (order 8) of h [s]: y is replaced.

    Args:
        robot: the true one.
        rule: its grasp.
        push: (17+n,) what acts.
        y: (27+2n,) state, see ``GraspDynamics``.
        h: length [s].
        work: overwritten.
    """
    stages, trial = work.stages, work.trial
    for stage in range(STAGES):
        _weigh(y, A[stage], h, stage, stages, trial)
        grasp_slope(robot, rule, push, trial, work, stages[stage])
    _weigh(y, B, h, STAGES, stages, trial)
    for i in range(y.shape[0]):
        y[i] = trial[i]


@inner
def _weigh(y: Vector, weights: Vector, h: float, count: int, stages: Vector, out: Vector) -> None:
    """Write y plus the weighted slopes so far."""
    for i in range(y.shape[0]):
        out[i] = y[i]
    for stage in range(count):
        weight = h * weights[stage]
        if weight != 0.0:
            for i in range(y.shape[0]):
                out[i] += weight * stages[stage, i]


@kernel
def grasp_slope(robot: RobotArrays, rule: GraspRule, push: Vector, y: Vector, work: GraspWork, dy: Vector) -> None:
    """Write dy/dt."""
    n = work.effort.shape[0]
    bristle, twist, omega = 13 + 2 * n, three(y, 7 + n), three(y, 10 + n)
    turn = matrix(attitude(y))
    dy[bristle] = _efforts(rule, push, y, work.effort)
    wheel_torque, wheels = three(y, bristle + 1), three(y, bristle + 4)
    force = add(three(push, FORCE), mul_t(turn, three(push, OUTSIDE_FORCE)))
    external = add(three(push, MOMENT), mul_t(turn, three(push, OUTSIDE_TORQUE)))
    torque = sub(add(external, wheel_torque), cross(omega, wheels))
    forward_dynamics(robot, y, force, torque, work.effort, work.bodies, dy)
    dy[0], dy[1], dy[2] = mul(turn, twist)
    dy[3], dy[4], dy[5], dy[6] = quaternion_rate(attitude(y), omega)
    # The torque has the gyroscopic part, which does no work: it is at right angles to omega.
    power = dot(force, twist) + dot(torque, omega)
    for joint in range(n):
        rate = y[13 + n + joint]
        dy[7 + joint] = rate
        power += work.effort[joint] * rate
    _book(rule, push, y, bristle + 1, power, mul(turn, force), mul(turn, external), dy)


@inner
def _book(rule: GraspRule, push: Vector, y: Vector, at: int, power: float, force: Vec, moment: Vec, dy: Vector) -> None:
    """Wheels, work and impulse: their places in the state begin at ``at``; force and moment in inertial axes."""
    turning = add(cross(three(y, 0), force), moment)
    for k in range(3):
        dy[at + k] = (push[TORQUE + k] - y[at + k]) / rule.lag if rule.lag > 0.0 else 0.0
        dy[at + 3 + k] = -y[at + k]
        dy[at + 7 + k], dy[at + 10 + k] = force[k], turning[k]
    dy[at + 6] = power


@inner
def _efforts(rule: GraspRule, push: Vector, y: Vector, effort: Vector) -> float:
    """Write the efforts of motors and grasp; returns how the bristle stretches [rad/s]."""
    n = effort.shape[0]
    for joint in range(n):
        effort[joint] = push[EFFORT + joint]
    first, second, third = rule.joints[0], rule.joints[1], rule.joints[2]
    bristle, rate = y[13 + 2 * n], y[13 + n + third] - push[TURNING]
    stretch: float = rate - abs(rate) * rule.torsional_stiffness * bristle / rule.slip_torque
    effort[first] = -rule.stiffness * (y[7 + first] - push[REST]) - rule.damping * y[13 + n + first]
    effort[second] = -rule.stiffness * y[7 + second] - rule.damping * y[13 + n + second]
    effort[third] = -rule.torsional_stiffness * bristle - rule.torsional_damping * stretch
    return stretch
