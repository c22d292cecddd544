"""One answer of the reaction null space law, from state and reference to command and telemetry.

The symbols are those of ``ReactionNullSpace``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.mass import MassWork, inertia_times, mass_work
from space_robot_control.kernel.nominal import actuated_forces, add_gyroscopic
from space_robot_control.kernel.tracking import track
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.dense import dot_product, factor, solve
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class NullSpaceRule(NamedTuple):
    """The numbers of the law.

    Attributes:
        period: T [s].
        stiffness: k [1/s].
        decay: w' [1/s].
        bandwidth: wn' [rad/s].
        weight: lambda.
        mass: of the nominal robot [kg].
        floating: 1: no force acts on the base.
        gyroscopic: 1: omega x h of the wheels is part of the command.
    """

    period: float
    stiffness: float
    decay: float
    bandwidth: float
    weight: float
    mass: float
    floating: int
    gyroscopic: int


class NullSpaceMemory(NamedTuple):
    """What one answer is made of; b rows of the base: 3, or 6 of one that is pushed.

    Attributes:
        configuration: (6+n,) tracking errors.
        velocity: (6+n,) tracking errors.
        feedforward: (6+n,) tracking errors.
        quaternion: (4,) tracking errors.
        acceleration: (6+n,) a.
        ahead: (7+n,) configuration one period ahead.
        rates: (n,) q_d' + k e.
        now: (n,) s.
        later: (n,) s_1.
        jacobian: (b, n) J.
        square: (b, b) factors.
        pivots: (b,) of them.
        column: (b,) right side and solution.
        work: of the inertia.
    """

    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    ahead: npt.NDArray[np.float64]
    rates: npt.NDArray[np.float64]
    now: npt.NDArray[np.float64]
    later: npt.NDArray[np.float64]
    jacobian: npt.NDArray[np.float64]
    square: npt.NDArray[np.float64]
    pivots: npt.NDArray[np.int64]
    column: npt.NDArray[np.float64]
    work: MassWork


class NullSpaceContext(NamedTuple):
    """A law: its numbers, its memory, the nominal robot."""

    rule: NullSpaceRule
    memory: NullSpaceMemory
    robot: RobotArrays


def null_space_memory(joints: int, base: int, followers: int = 0) -> NullSpaceMemory:
    """Memory for that many joints, rows of the base, and joints that follow others."""
    size, rates = 6 + joints, (np.zeros(joints), np.zeros(joints), np.zeros(joints))
    errors = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(4)
    squares, pivots, column = (
        (np.zeros((base, joints)), np.zeros((base, base))),
        np.zeros(base, np.int64),
        np.zeros(base),
    )
    motion = *errors, np.zeros(size), np.zeros(7 + joints), *rates
    return NullSpaceMemory(*motion, *squares, pivots, column, mass_work(joints, followers))


def _example() -> NullSpaceContext:
    none = np.zeros((1, 1))
    robot = RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)
    return NullSpaceContext(NullSpaceRule(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0, 0), null_space_memory(0, 3), robot)


NULL_SPACE = kind_of(_example())


@kernel
def keep(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def answer(
    context: Any,
    q: Vector,
    v: Vector,
    effort: Vector,
    acceleration: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    u: Vector,
    row: Vector,
) -> int:
    """See ``kernel.answers``; the blocks of ``row`` are those of ``ReactionNullSpace``, in its order."""
    law = loaded(context, NULL_SPACE)
    rule, memory, size = law.rule, law.memory, v.shape[0]
    track(q, v, q_d, v_d, a_d, memory.configuration, memory.velocity, memory.feedforward, memory.quaternion)
    for i in range(size):
        row[i], row[size + i] = memory.configuration[i], memory.velocity[i]
    if not _command_rates(law, q, v, v_d, a_d, row[2 * size :]):
        return UNUSABLE
    _accelerate(rule, memory, v)
    if not actuated_forces(law.robot, rule.mass, rule.floating, q, v, memory.acceleration, memory.work.bodies, u):
        return UNUSABLE
    if rule.gyroscopic:
        add_gyroscopic(wheels, v, u)
    return ANSWERED


@inner
def _command_rates(law: NullSpaceContext, q: Vector, v: Vector, v_d: Vector, a_d: Vector, row: Vector) -> bool:
    """Write s, s_1, and of telemetry s and J s. False: an inertia has no inverse."""
    rule, memory, n = law.rule, law.memory, law.memory.now.shape[0]
    for i in range(n):
        memory.rates[i] = v_d[6 + i] + rule.stiffness * memory.configuration[6 + i]
    if not (_couple(law, q) and _filter(rule, memory, memory.now)):
        return False
    for i in range(n):
        row[i] = memory.now[i]
    for i in range(memory.column.shape[0]):
        row[n + i] = dot_product(memory.jacobian[i], memory.now)
    for i in range(7):
        memory.ahead[i] = q[i]
    for i in range(n):
        memory.ahead[7 + i] = q[7 + i] + rule.period * v[6 + i]
        error = memory.configuration[6 + i] + rule.period * memory.velocity[6 + i]
        memory.rates[i] = v_d[6 + i] + rule.period * a_d[6 + i] + rule.stiffness * error
    return _couple(law, memory.ahead) and _filter(rule, memory, memory.later)


@inner
def _accelerate(rule: NullSpaceRule, memory: NullSpaceMemory, v: Vector) -> None:
    """Write a = [a_b, a_J]."""
    wn = rule.bandwidth
    for i in range(6):
        back = 2.0 * wn * memory.velocity[i] + wn * wn * memory.configuration[i]
        memory.acceleration[i] = memory.feedforward[i] + back
    for i in range(memory.now.shape[0]):
        change = (memory.later[i] - memory.now[i]) / rule.period
        memory.acceleration[6 + i] = change + rule.decay * (memory.now[i] - v[6 + i])


@inner
def _couple(law: NullSpaceContext, q: Vector) -> bool:
    """Write J = -H_b^-1 H_bm of a configuration. False: H_b has no inverse.

    A column of H is the force of a unit acceleration; H is symmetric, so that columns of the base are enough.
    """
    rule, memory, work = law.rule, law.memory, law.memory.work
    b, n = memory.jacobian.shape
    first = 6 - b
    for j in range(b):
        for i in range(6 + n):
            work.acceleration[i] = 1.0 if i == first + j else 0.0
        if not inertia_times(law.robot, rule.mass, rule.floating, q, work.acceleration, work, work.force):
            return False
        for i in range(b):
            memory.square[i, j] = work.force[first + i]
        for i in range(n):
            memory.jacobian[j, i] = -work.force[6 + i]
    if not factor(memory.square, memory.pivots):
        return False
    for i in range(n):
        for j in range(b):
            memory.column[j] = memory.jacobian[j, i]
        solve(memory.square, memory.pivots, memory.column)
        for j in range(b):
            memory.jacobian[j, i] = memory.column[j]
    return True


@inner
def _filter(rule: NullSpaceRule, memory: NullSpaceMemory, out: Vector) -> bool:
    """Write N r (n,) of the rates: r - lambda^2 J^T (I + lambda^2 J J^T)^-1 J r. False: no inverse."""
    jacobian, square, b = memory.jacobian, memory.square, memory.column.shape[0]
    weight = rule.weight * rule.weight
    for i in range(b):
        for j in range(b):
            square[i, j] = weight * dot_product(jacobian[i], jacobian[j]) + (1.0 if i == j else 0.0)
        memory.column[i] = weight * dot_product(jacobian[i], memory.rates)
    if not factor(square, memory.pivots):
        return False
    solve(square, memory.pivots, memory.column)
    for k in range(out.shape[0]):
        back = 0.0
        for i in range(b):
            back += jacobian[i, k] * memory.column[i]
        out[k] = memory.rates[k] - back
    return True
