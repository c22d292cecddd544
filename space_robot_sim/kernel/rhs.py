"""The right-hand side: how the state changes while actuators hold their commands.

State y, N = 20 + 2n numbers: position(3) inertial, quaternion(4) xyzw, joints(n) | linear(3), angular(3) body frame,
joint rates(n) | work of all applied forces(1), linear(3) and angular(3) impulse of external ones, about the inertial
origin | of flexible robots: work lost in dampers(1), motor angles(k), motor rates(k), see `kernel.flexible`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix, quaternion_rate
from space_robot_description.kernel.spatial import Vec, add, cross, dot, get3, mul, scaled
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp, tanh
from space_robot_sim.kernel.aba import forward_dynamics
from space_robot_sim.kernel.articulated import WORKSPACE
from space_robot_sim.kernel.coupled import CoupledMemory, coupled_dynamics, coupled_memory
from space_robot_sim.kernel.disturbance import NOTHING, count_disturbance, disturbance_wrench
from space_robot_sim.kernel.flexible import RIGID, driven_rate, spring_efforts
from space_robot_sim.kernel.tableau import STAGES

QUADRATURES = 7
# Columns of `segments`: begin and end [s], force, external torque, wheel momentum rate, wheel momentum at begin.
BEGIN, END, FORCE, TORQUE, RATE, STORED, SEGMENT_SIZE = constants(0, 1, 2, 5, 8, 11, 14)
LAG, VISCOUS, COULOMB, COULOMB_VELOCITY = constants(0, 1, 2, 3)
(FIRST,) = constants(0)


class Drive(NamedTuple):
    """What the actuators do during one control period; time counts from its beginning.

    Attributes:
        segments: (k, 14) times between which force, torque and wheel torque are constant, all in the body frame.
        effort: (n,) joint efforts asked of the motors [N m or N].
        start_effort: (n,) joint efforts at the beginning of the period.
        disturbance: what pushes the base beside them, see `kernel.disturbance`; (0,): nothing.
        springs: (n, 5) of joints and gears, see `kernel.flexible`; (0, 5): all is rigid.
    """

    segments: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    start_effort: npt.NDArray[np.float64]
    disturbance: npt.NDArray[np.float64] = NOTHING
    springs: npt.NDArray[np.float64] = RIGID


class Scratch(NamedTuple):
    """Memory the kernel works in, made once.

    ``slope`` holds dy/dt at the end of the period just integrated, ``error`` (1,) the estimated errors of all steps so
    far, summed [m or rad].
    """

    stages: npt.NDArray[np.float64]
    trial: npt.NDArray[np.float64]
    slope: npt.NDArray[np.float64]
    bodies: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    coupled: CoupledMemory


def scratch(joints: int, followers: int = 0, more: int = 0) -> Scratch:
    """Memory for a robot with that many joints, others that follow them, and so many further states."""
    size = 13 + 2 * joints + QUADRATURES + more
    bodies, effort = np.zeros((1 + joints + followers, WORKSPACE)), np.zeros(joints)
    coupled = coupled_memory(joints, followers)
    return Scratch(np.zeros((STAGES, size)), np.zeros(size), np.zeros(size), bodies, effort, np.zeros(1), coupled)


@inner
def motor_effort(asked: float, start: float, lag: float, t: float) -> float:
    """Effort of a first-order motor t after its command changed from ``start`` to ``asked``."""
    return asked + (start - asked) * exp(-t / lag) if lag > 0.0 else asked


@inner
def joint_efforts(robot: RobotArrays, drive: Drive, t: float, y: Vector, out: Vector) -> float:
    """Motor effort less friction at every joint; returns their power [W]."""
    n = drive.effort.shape[0]
    power = 0.0
    for joint in range(n):
        rate = driven_rate(drive.springs, y, joint, y[13 + n + joint])
        effort = motor_effort(drive.effort[joint], drive.start_effort[joint], robot.motors[joint, LAG], t)
        effort -= robot.motors[joint, VISCOUS] * rate
        coulomb = robot.motors[joint, COULOMB]
        if coulomb > 0.0:
            effort -= coulomb * tanh(rate / robot.motors[joint, COULOMB_VELOCITY])
        out[joint] = effort
        power += effort * rate
    return power


@inner
def base_torque(drive: Drive, k: int, t: float, omega: Vec) -> Vec:
    """Moment on the base: external torque and the wheels' reaction, -d/dt of their momentum in inertial space."""
    stored, rate = get3(drive.segments, k, STORED), get3(drive.segments, k, RATE)
    momentum = add(stored, scaled(t - drive.segments[k, BEGIN], rate))
    reaction = add(rate, cross(omega, momentum))
    return add(get3(drive.segments, k, TORQUE), scaled(-1.0, reaction))


@inner
def kinematics(y: Vector, n: int, dy: Vector) -> None:
    """Rates of position, quaternion (1/2 q omega) and joints."""
    v, omega = (y[7 + n], y[8 + n], y[9 + n]), (y[10 + n], y[11 + n], y[12 + n])
    dy[0], dy[1], dy[2] = mul(matrix(attitude(y)), v)
    dy[3], dy[4], dy[5], dy[6] = quaternion_rate(attitude(y), omega)
    for joint in range(n):
        dy[7 + joint] = y[13 + n + joint]


@inner
def quadratures(drive: Drive, k: int, joint_power: float, y: Vector, dy: Vector) -> None:
    """Power of everything applied, and external force and moment in the inertial frame (the wheels' are internal)."""
    n = drive.effort.shape[0]
    q = 13 + 2 * n
    v, omega = (y[7 + n], y[8 + n], y[9 + n]), (y[10 + n], y[11 + n], y[12 + n])
    force, torque, rate = get3(drive.segments, k, FORCE), get3(drive.segments, k, TORQUE), get3(drive.segments, k, RATE)
    turn = matrix(attitude(y))
    inertial = mul(turn, force)
    # The gyroscopic torque is normal to omega and does no work.
    dy[q] = joint_power + dot(force, v) + dot(torque, omega) - dot(rate, omega)
    dy[q + 1], dy[q + 2], dy[q + 3] = inertial
    dy[q + 4], dy[q + 5], dy[q + 6] = add(cross((y[0], y[1], y[2]), inertial), mul(turn, torque))


@kernel
def slope(robot: RobotArrays, drive: Drive, k: int, t: float, y: Vector, dy: Vector, memory: Scratch) -> None:
    """dy/dt in segment k, t seconds after the beginning of the period."""
    n = drive.effort.shape[0]
    omega = (y[10 + n], y[11 + n], y[12 + n])
    power = joint_efforts(robot, drive, t, y, memory.effort)
    if drive.springs.shape[0]:
        power -= spring_efforts(drive.springs, y, memory.effort, dy)
    torque = base_torque(drive, k, t, omega)
    force = get3(drive.segments, k, FORCE)
    if drive.disturbance.shape[0]:
        push, twist = disturbance_wrench(drive.disturbance, y)
        force, torque = add(force, push), add(torque, twist)
    if robot.coupling.shape[0]:
        coupled_dynamics(robot, y, force, torque, memory.effort, memory.coupled, dy)
    else:
        forward_dynamics(robot, y, force, torque, memory.effort, memory.bodies, dy)
    kinematics(y, n, dy)
    quadratures(drive, k, power, y, dy)
    if drive.disturbance.shape[0]:
        count_disturbance(drive.disturbance, n, y, dy)
