"""One answer of a terminal sliding mode law, from state and reference to command and telemetry.

The symbols are those of ``TerminalSliding``, ``Ntsmc`` and ``NtsmcEuler``: [Giordano and Cenedese 2023, secs. IV, V].
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.actuators import Actuators, clip, scale_down, within
from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.nominal import actuated_forces, add_gyroscopic, sum_of_squares
from space_robot_control.kernel.tracking import track
from space_robot_control.laws.ntsmc.kernel.euler import body_acceleration, euler_rates, nearest, wrapped
from space_robot_control.laws.ntsmc.kernel.sliding import DELTA, LOOP_GAIN, ROWS, XI, S, SlidingRule, adapt, slide
from space_robot_control.laws.ntsmc.kernel.terminal import (
    DESIRED,
    E_DOT,
    RATE,
    E,
    accelerate,
    rotation_errors,
    stack,
)
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.quaternion import attitude, put, rotate_inverse, three
from space_robot_description.kernel.spatial import Vec, cross, sub
from space_robot_msgs_py.interfaces import Vector

# How the attitude is represented.
QUATERNION, UNWRAPPED, WRAPPED = constants(0, 1, 2)
# Rows of the angles that are remembered.
ACTUAL, WANTED, ANGLES, RATES = constants(0, 1, 2, 3)


class TerminalRule(NamedTuple):
    """The numbers of a law besides those of its sliding mode.

    Attributes:
        attitude: QUATERNION, UNWRAPPED or WRAPPED.
        floating: 1: no force acts on the base.
        mass: of the nominal robot [kg].
        gyroscopic: 1: omega x h of the wheels is part of the command.
        preserve: 1: a command is scaled in the direction of its acceleration, 0: clipped.
        keep: share of K_hat that a period leaves.
        cap: largest K_hat.
        rate: phi.
        freeze: 1: K_hat stays while a command is beyond the limits.
        min_cosine: lower bound of |cos pitch|.
    """

    attitude: int
    floating: int
    mass: float
    gyroscopic: int
    preserve: int
    keep: float
    cap: float
    rate: float
    freeze: int
    min_cosine: float


class TerminalMemory(NamedTuple):
    """What a law remembers, and what one answer is made of.

    Attributes:
        estimate: (m,) K_hat.
        angles: (4, 3) last roll, pitch, yaw of the base and of its reference; those of this answer and their rates.
        disturbance: (6+n,) d of the observer.
        acceleration: (6+n,) that the unsaturated command causes in the nominal robot.
        configuration: (6+n,) tracking errors.
        velocity: (6+n,) tracking errors.
        feedforward: (6+n,) tracking errors.
        quaternion: (4,) tracking errors.
        rotation: (4, 3) errors of the representation.
        errors: (3, m) e, its rate, its derivative.
        terms: (6, m) see ``slide``.
        turned: (3,) acceleration of the representation.
        bias: (6+n,) C0.
        work: of the inverse dynamics.
    """

    estimate: npt.NDArray[np.float64]
    angles: npt.NDArray[np.float64]
    disturbance: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]
    rotation: npt.NDArray[np.float64]
    errors: npt.NDArray[np.float64]
    terms: npt.NDArray[np.float64]
    turned: npt.NDArray[np.float64]
    bias: npt.NDArray[np.float64]
    work: npt.NDArray[np.float64]


class Terminal(NamedTuple):
    """A law: its numbers, its memory, the nominal robot."""

    rule: TerminalRule
    mode: SlidingRule
    memory: TerminalMemory
    robot: RobotArrays
    able: Actuators


def terminal_memory(joints: int, size: int, followers: int = 0) -> TerminalMemory:
    """Memory for that many joints and sliding variables, and joints that follow others."""
    dof = 6 + joints
    return TerminalMemory(
        estimate=np.zeros(size),
        angles=np.zeros((4, 3)),
        disturbance=np.zeros(dof),
        acceleration=np.zeros(dof),
        configuration=np.zeros(dof),
        velocity=np.zeros(dof),
        feedforward=np.zeros(dof),
        quaternion=np.zeros(4),
        rotation=np.zeros((4, 3)),
        errors=np.zeros((3, size)),
        terms=np.zeros((ROWS, size)),
        turned=np.zeros(3),
        bias=np.zeros(dof),
        work=np.zeros((1 + joints + followers, MOTION_SIZE)),
    )


def _example() -> Terminal:
    one, none = np.zeros(1), np.zeros((1, 1))
    rule = TerminalRule(0, 0, 1.0, 0, 0, 1.0, 1.0, 1.0, 0, 1.0)
    mode = SlidingRule(one, one, np.zeros(1, dtype=np.int64), 1.0, 1.0, 1.0, 0, 1.0, 1.0, 1.0, 1.0)
    robot = RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)
    return Terminal(rule, mode, terminal_memory(0, 1), robot, Actuators(one, none, none, 1.0))


TERMINAL = kind_of(_example())


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``TerminalSliding``, in its order."""
    law = loaded(context, TERMINAL)
    rule, memory = law.rule, law.memory
    first = 3 if rule.floating else 0
    track(q, v, q_d, v_d, a_d, memory.configuration, memory.velocity, memory.feedforward, memory.quaternion)
    _rotate(rule, q, v, q_d, v_d, a_d, memory)
    speed_squared = sum_of_squares(v, first)
    stack(q, memory.configuration, memory.velocity, memory.rotation, memory.errors)
    e = memory.errors
    slide(law.mode, memory.estimate, e[E], e[RATE], e[E_DOT], speed_squared, memory.terms)
    wanted = memory.acceleration
    accelerate(q, memory.feedforward, memory.rotation[DESIRED], memory.terms, memory.turned, wanted)
    put(wanted, 3, _angular(rule, q, three(memory.turned, 0), memory))
    for i in range(wanted.shape[0]):
        wanted[i] -= memory.disturbance[i]
    if not actuated_forces(law.robot, rule.mass, rule.floating, q, v, wanted, memory.work, u):
        return UNUSABLE
    if rule.gyroscopic:
        add_gyroscopic(wheels, v, u)
    saturated = not within(law.able, u)
    _show(memory, q, q_d, u, saturated, row)
    if not (saturated and rule.freeze):
        growth = law.mode.period * rule.rate * (1.0 + speed_squared)
        adapt(memory.terms[XI], growth, rule.keep, rule.cap, memory.estimate)
    if saturated:
        return _saturate(law, q, v, wheels, u)
    return ANSWERED


@inner
def _rotate(
    rule: TerminalRule, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector, memory: TerminalMemory
) -> None:
    """Write the errors of the representation: rows e, rate, e_dot and desired."""
    out = memory.rotation
    if rule.attitude == QUATERNION:
        rotation_errors(q, v, q_d, a_d, memory.quaternion, memory.velocity, out)
        return
    theta, theta_d = nearest(attitude(q), memory.angles[ACTUAL]), nearest(attitude(q_d), memory.angles[WANTED])
    put(memory.angles[ACTUAL], 0, theta)
    put(memory.angles[WANTED], 0, theta_d)
    rates = euler_rates(theta, three(v, 3), rule.min_cosine)
    rates_d = euler_rates(theta_d, three(v_d, 3), rule.min_cosine)
    # alpha = N theta'' + N' theta', so theta''_d = N^-1 (alpha_d - N' theta'_d).
    drift = body_acceleration(theta_d, rates_d, (0.0, 0.0, 0.0))
    e = sub(theta, theta_d)
    if rule.attitude == WRAPPED:
        e = (wrapped(e[0]), wrapped(e[1]), wrapped(e[2]))
    put(out[E], 0, e)
    put(out[RATE], 0, sub(rates, rates_d))
    put(out[E_DOT], 0, sub(rates, rates_d))
    put(out[DESIRED], 0, euler_rates(theta_d, sub(three(a_d, 3), drift), rule.min_cosine))
    put(memory.angles[ANGLES], 0, theta)
    put(memory.angles[RATES], 0, rates)


@inner
def _angular(rule: TerminalRule, q: Vector, acceleration: Vec, memory: TerminalMemory) -> Vec:
    """Derivative of the body rates for an acceleration of the representation: R^T w', or N theta'' + N' theta'."""
    if rule.attitude == QUATERNION:
        return rotate_inverse(attitude(q), acceleration)
    return body_acceleration(three(memory.angles[ANGLES], 0), three(memory.angles[RATES], 0), acceleration)


@inner
def _saturate(law: Terminal, q: Vector, v: Vector, wheels: Vector, u: Vector) -> int:
    """Bring the command within the limits; C0 is the u of x'' = 0."""
    rule, memory = law.rule, law.memory
    if not rule.preserve:
        clip(law.able, u)
        return ANSWERED
    # The derivative of v that keeps x'.
    still = memory.feedforward
    for i in range(6, still.shape[0]):
        still[i] = 0.0
    put(still, 0, cross(three(v, 0), three(v, 3)))
    put(still, 3, _angular(rule, q, (0.0, 0.0, 0.0), memory))
    if not actuated_forces(law.robot, rule.mass, rule.floating, q, v, still, memory.work, memory.bias):
        return UNUSABLE
    if rule.gyroscopic:
        add_gyroscopic(wheels, v, memory.bias)
    scale_down(law.able, memory.bias, u)
    return ANSWERED


@inner
def _show(memory: TerminalMemory, q: Vector, q_d: Vector, u: Vector, saturated: bool, row: Vector) -> None:
    """Write the telemetry."""
    size, m = u.shape[0], memory.estimate.shape[0]
    for i in range(size):
        row[i], row[size + i] = memory.configuration[i], memory.velocity[i]
    at = 2 * size
    for i in range(m):
        row[at + i], row[at + m + i] = memory.terms[S, i], memory.terms[DELTA, i]
        row[at + 2 * m + i], row[at + 3 * m + i] = memory.terms[XI, i], memory.estimate[i]
        row[at + 4 * m + 1 + i] = memory.terms[LOOP_GAIN, i]
    row[at + 4 * m] = q[3] * q_d[3] + q[4] * q_d[4] + q[5] * q_d[5] + q[6] * q_d[6]
    at += 5 * m + 1
    for i in range(size):
        row[at + i], row[at + size + 2 + i] = u[i], memory.disturbance[i]
    row[at + size] = math.sqrt(sum_of_squares(u, 0))
    row[at + size + 1] = 1.0 if saturated else 0.0
