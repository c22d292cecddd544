"""What laws with the regulator of a posture have in common: feed-forward, its state x, and the posture in force."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.mass import MassWork, mass_work
from space_robot_control.kernel.matrices import add_scaled
from space_robot_control.kernel.nominal import actuated_forces, add_gyroscopic
from space_robot_control.kernel.tracking import track
from space_robot_control.laws.lqr.kernel.design import DesignMemory, RegulatorRule, design_memory, make_design
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import called, inner
from space_robot_msgs_py.interfaces import Vector

MADE, DESIGNS = range(2)


class RegulatorMemory(NamedTuple):
    """What one answer is made of, and the regulator in force.

    Attributes:
        configuration: (6+n,) tracking errors.
        velocity: (6+n,) tracking errors.
        feedforward: (6+n,) tracking errors.
        quaternion: (4,) tracking errors.
        acceleration: (6+n,) of the feed-forward.
        x: (2m,) errors and rates in shares of what is accepted.
        free: (2m, N m) z = free^T x, the inputs of N periods in shares of the limits, one after the other.
        z: (N m,).
        counts: (2,) whether there is a design, designs so far.
        work: of the inertia.
        design: in force.
    """

    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    x: npt.NDArray[np.float64]
    free: npt.NDArray[np.float64]
    z: npt.NDArray[np.float64]
    counts: npt.NDArray[np.int64]
    work: MassWork
    design: DesignMemory


def regulator_memory(joints: int, inputs: int, periods: int = 1, followers: int = 0) -> RegulatorMemory:
    """Memory for n joints and m inputs over N periods, and joints that follow others."""
    size, s = 6 + joints, 2 * inputs
    errors = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(4), np.zeros(size)
    inside = np.zeros(s), np.zeros((s, periods * inputs)), np.zeros(periods * inputs), np.zeros(2, dtype=np.int64)
    return RegulatorMemory(*errors, *inside, mass_work(joints, followers), design_memory(joints, inputs))


def regulator_example() -> tuple[RegulatorRule, RegulatorMemory, RobotArrays]:
    """Of the types that all laws are compiled for."""
    one, none = np.zeros(1), np.zeros((1, 1))
    rule = RegulatorRule(one, one, one, 1.0, 1.0, 1.0, 0, 0)
    return rule, regulator_memory(0, 3), RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)


@called
def regulate(
    rule: RegulatorRule,
    memory: RegulatorMemory,
    robot: RobotArrays,
    q: Vector,
    v: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    u: Vector,
) -> int:
    """Write the feed-forward into u (6+n,), x, and z of the regulator in force; returns a status."""
    track(q, v, q_d, v_d, a_d, memory.configuration, memory.velocity, memory.feedforward, memory.quaternion)
    for i in range(u.shape[0]):
        memory.acceleration[i] = memory.feedforward[i]
    if not actuated_forces(robot, rule.mass, rule.floating, q, v, memory.acceleration, memory.work.bodies, u):
        return UNUSABLE
    if rule.gyroscopic:
        add_gyroscopic(wheels, v, u)
    status: int = _choose_design(rule, memory, robot, q)
    if status != ANSWERED:
        return status
    m = rule.effort.shape[0]
    first = u.shape[0] - m
    for i in range(m):
        memory.x[i] = memory.configuration[first + i] / rule.error[i]
        memory.x[m + i] = memory.velocity[first + i] / rule.rate[i]
    for i in range(memory.z.shape[0]):
        memory.z[i] = 0.0
    for k in range(2 * m):
        add_scaled(memory.z, memory.x[k], memory.free[k])
    return ANSWERED


@inner
def show(rule: RegulatorRule, memory: RegulatorMemory, u: Vector, row: Vector) -> int:
    """Add the first inputs of z to u, and write the telemetry of ``Lqr``; returns how many numbers there are."""
    size, m = u.shape[0], rule.effort.shape[0]
    for i in range(size):
        row[i], row[size + i] = memory.configuration[i], memory.velocity[i]
    for i in range(m):
        feedback = rule.effort[i] * memory.z[i]
        row[2 * size + i] = feedback
        u[size - m + i] += feedback
    row[2 * size + m] = float(memory.counts[DESIGNS])
    written: int = 2 * size + m + 1
    return written


@called
def _choose_design(rule: RegulatorRule, memory: RegulatorMemory, robot: RobotArrays, q: Vector) -> int:
    """Keep the regulator of the last posture, or make one where the arm has left it."""
    design = memory.design
    left = memory.counts[MADE] == 0
    for i in range(design.joints.shape[0]):
        left = left or abs(q[7 + i] - design.joints[i]) > rule.posture_step
    if not left:
        return ANSWERED
    memory.counts[MADE] = 0
    status: int = make_design(rule, robot, q, memory.work, design)
    if status == ANSWERED:
        _look_ahead(memory)
        memory.counts[MADE] = 1
        memory.counts[DESIGNS] += 1
    return status


@inner
def _look_ahead(memory: RegulatorMemory) -> None:
    """Write the inputs over the horizon where no limit is met: -K (A - B K)^k x in period k.

    That is the least cost for every N, since X stands for all periods after the N-th.
    """
    design, free = memory.design, memory.free
    m, s = design.gain.shape
    for i in range(m):
        for k in range(s):
            free[k, i] = -design.gain[i, k]
    for at in range(m, free.shape[1], m):
        # Rows of period k + 1 = rows of period k times A - B K; transposed here.
        for j in range(s):
            later = free[j, at : at + m]
            for i in range(m):
                later[i] = 0.0
            for k in range(s):
                add_scaled(later, design.closed[k, j], free[k, at - m : at])
