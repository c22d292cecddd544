"""One cycle of the adaptive law: the rows that a period teaches, and the command that answers a state.

Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (31)-(45); the words are those of ``laws.adaptive``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.euler import (
    PITCH,
    ROLL,
    YAW,
    angles,
    body_torque_in,
    coordinates,
    generalised_torque_in,
    second_derivative,
    short_way_in,
)
from space_robot_control.kernel.least_squares import dot_product
from space_robot_control.kernel.motion import move
from space_robot_control.kernel.regressor import PER_BODY, momentum_and_energy, slotine_li, total_mass
from space_robot_control.kernel.tree import ROOT, TURN, Places, Tree, places
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.spatial import add, cross, get9, mul, mul_t, rotation, scaled, sub
from space_robot_msgs_py.interfaces import Vector

MODEL, ACCELEROMETER, VELOCITY = 0, 1, 2  # where the acceleration of the base comes from


class Rule(NamedTuple):
    """The law in numbers; m = 6 + n - first.

    Attributes:
        first: first actuated degree of freedom: 3 where the base translates freely, 0 where it is pushed.
        period: control period [s].
        half: half of it with lead, 0 without [s].
        on_velocity: 1: Lambda weighs the rate of the error.
        weight: (m,) Lambda.
        damping: (m, m) K_D.
        source: MODEL, ACCELEROMETER or VELOCITY, for learning.
        noise: (m,) standard deviation of the rows [N, N m].
    """

    first: int
    period: float
    half: float
    on_velocity: int
    weight: npt.NDArray[np.float64]
    damping: npt.NDArray[np.float64]
    source: int
    noise: npt.NDArray[np.float64]


class Held(NamedTuple):
    """What a period starts with and what acts over it.

    Attributes:
        x: (6+n,) Euler coordinates.
        dx: (6+n,) their rates.
        omega: (3,) body rate [rad/s].
        wheels: (3,) momentum of the wheels in the middle of the period, body frame [N m s].
        wrench: (6,) commanded on the base, body frame [N, N m].
    """

    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    omega: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    wrench: npt.NDArray[np.float64]


class Desk(NamedTuple):
    """Memory of a cycle: what is left on it is read by the law until the next one.

    Attributes:
        places: of the bodies.
        x: (6+n,) coordinates for which is computed, with lead half a period on.
        dx: (6+n,) their rates.
        x_d: (6+n,) desired.
        dx_d: (6+n,) desired.
        ddx_d: (6+n,) desired.
        before: (7+n,) desired x'' of the cycle before, and 1 if there was one.
        dx_r: (6+n,) reference velocity.
        ddx_r: (6+n,) reference acceleration.
        still: (6+n,) zeros.
        error: (m,) desired minus actual.
        sigma: (m,) sliding variable.
        entailed: (6+n,) sigma with the translation it entails.
        rows: (6+n, P) regressor of the command.
    """

    places: Places
    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    x_d: npt.NDArray[np.float64]
    dx_d: npt.NDArray[np.float64]
    ddx_d: npt.NDArray[np.float64]
    before: npt.NDArray[np.float64]
    dx_r: npt.NDArray[np.float64]
    ddx_r: npt.NDArray[np.float64]
    still: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    sigma: npt.NDArray[np.float64]
    entailed: npt.NDArray[np.float64]
    rows: npt.NDArray[np.float64]


def desk_for(joints: int, first: int) -> Desk:
    """Memory for a robot with that many joints, whose first actuated degree of freedom is this one."""
    size = 6 + joints
    return Desk(
        places=places(joints),
        x=np.zeros(size),
        dx=np.zeros(size),
        x_d=np.zeros(size),
        dx_d=np.zeros(size),
        ddx_d=np.zeros(size),
        before=np.zeros(size + 1),
        dx_r=np.zeros(size),
        ddx_r=np.zeros(size),
        still=np.zeros(size),
        error=np.zeros(size - first),
        sigma=np.zeros(size - first),
        entailed=np.zeros(size),
        rows=np.zeros((size, PER_BODY * (1 + joints))),
    )


@kernel
def answer(
    tree: Tree,
    rule: Rule,
    estimate: Vector,
    x: Vector,
    dx: Vector,
    omega: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    desk: Desk,
    u: Vector,
) -> float:
    """Write the command u (6+n,) and leave errors and regressor on the desk; returns the Lyapunov function [J].

    Args:
        tree: geometry of the robot.
        rule: the law.
        estimate: (P,) pi_hat.
        x: (6+n,) of the state.
        dx: (6+n,) of the state.
        omega: (3,) body rate [rad/s].
        wheels: (3,) their momentum, body frame [N m s].
        q_d: (7+n,) of the reference.
        v_d: (6+n,) of the reference.
        a_d: (6+n,) of the reference.
        desk: memory.
        u: (6+n,) [force, torque, efforts], base part in the body frame.
    """
    _desire(rule, q_d, v_d, a_d, desk)
    for i in range(x.shape[0]):
        desk.x[i] = x[i] + rule.half * (dx[i] + rule.half / 2.0 * desk.ddx_d[i])
        desk.dx[i] = dx[i] + rule.half * desk.ddx_d[i]
    _aim(rule, desk)
    falls = rule.first > 0
    slotine_li(tree, desk.places, desk.x, desk.dx, desk.dx_r, desk.ddx_r, estimate, falls, desk.rows)
    _command(rule, estimate, omega, wheels, desk, u)
    return _lyapunov_function(tree, rule, estimate, desk)


@kernel
def middle(
    tree: Tree,
    rule: Rule,
    estimate: Vector,
    held: Held,
    x: Vector,
    dx: Vector,
    q: Vector,
    v: Vector,
    effort: Vector,
    acceleration: Vector,
    desk: Desk,
    values: Vector,
) -> None:
    """Write the regressor in the middle of a period on the desk and what acted in values (6+n,), scaled to unit noise.

    Args:
        tree: geometry of the robot.
        rule: the law.
        estimate: (P,) pi_hat.
        held: start of the period.
        x: (6+n,) at its end.
        dx: (6+n,) at its end.
        q: (7+n,) of the state at its end.
        v: (6+n,) of the state at its end.
        effort: (n,) of the joints over it.
        acceleration: (3,) of the base, as an accelerometer reads it.
        desk: memory.
        values: (6+n,) generalised forces; those before ``rule.first`` mean nothing.
    """
    for i in range(x.shape[0]):
        step = x[i] - held.x[i]
        desk.x[i] = held.x[i] + 0.5 * (short_way_in(step) if i in (YAW, ROLL) else step)
        desk.dx[i] = 0.5 * (held.dx[i] + dx[i])
        desk.ddx_r[i] = (dx[i] - held.dx[i]) / rule.period
    if rule.source == ACCELEROMETER:
        read = (acceleration[0], acceleration[1], acceleration[2])
        desk.ddx_r[0], desk.ddx_r[1], desk.ddx_r[2] = mul(rotation(q[3], q[4], q[5], q[6]), read)
    elif rule.source == MODEL:
        desk.ddx_r[0], desk.ddx_r[1], desk.ddx_r[2] = 0.0, 0.0, 0.0
    falls = rule.source == MODEL
    slotine_li(tree, desk.places, desk.x, desk.dx, desk.dx, desk.ddx_r, estimate, falls, desk.rows)
    _acted(held, (v[3], v[4], v[5]), effort, desk, values)
    for row in range(rule.first, values.shape[0]):
        accuracy = 1.0 / rule.noise[row - rule.first]
        values[row] *= accuracy
        for column in range(estimate.shape[0]):
            desk.rows[row, column] *= accuracy


@inner
def _acted(held: Held, omega: tuple[float, float, float], effort: Vector, desk: Desk, values: Vector) -> None:
    """The generalised forces over the period, less what turns the wheels."""
    wrench, wheels = held.wrench, (held.wheels[0], held.wheels[1], held.wheels[2])
    mean = scaled(0.5, add((held.omega[0], held.omega[1], held.omega[2]), omega))
    torque = sub((wrench[3], wrench[4], wrench[5]), cross(mean, wheels))
    turn = get9(desk.places.bodies, ROOT, TURN)
    values[0], values[1], values[2] = mul(turn, (wrench[0], wrench[1], wrench[2]))
    values[ROLL], values[PITCH], values[YAW] = generalised_torque_in(angles(desk.x), torque)
    for joint in range(effort.shape[0]):
        values[6 + joint] = effort[joint]


@inner
def _desire(rule: Rule, q_d: Vector, v_d: Vector, a_d: Vector, desk: Desk) -> None:
    """Desired coordinates, with lead extrapolated by half a period: the reference is known at its stamp only."""
    coordinates(q_d, v_d, desk.x_d, desk.dx_d)
    second_derivative(q_d, v_d, a_d, desk.x_d, desk.dx_d, desk.ddx_d)
    half, size = rule.half, desk.x_d.shape[0]
    for i in range(size):
        ddx = desk.ddx_d[i]
        jerk = (ddx - desk.before[i]) / rule.period if desk.before[size] else 0.0
        desk.before[i] = ddx
        desk.x_d[i] += half * (desk.dx_d[i] + half / 2.0 * (ddx + half / 3.0 * jerk))
        desk.dx_d[i] += half * (ddx + half / 2.0 * jerk)
        desk.ddx_d[i] += half * jerk
    desk.before[size] = 1.0


@inner
def _aim(rule: Rule, desk: Desk) -> None:
    """Errors, sigma, Theta_r' and Theta_r''; the unactuated part of the latter two is zero."""
    for i in range(rule.first):
        desk.dx_r[i], desk.ddx_r[i] = 0.0, 0.0
    for i in range(rule.first, desk.x.shape[0]):
        k = i - rule.first
        off = desk.x_d[i] - desk.x[i]
        error = short_way_in(off) if i in (YAW, ROLL) else off
        weight, rate = rule.weight[k], desk.dx_d[i] - desk.dx[i]
        desk.error[k] = error
        desk.dx_r[i], desk.ddx_r[i] = desk.dx_d[i], desk.ddx_d[i]
        if rule.on_velocity:
            desk.sigma[k] = weight * rate + error
        else:
            desk.sigma[k] = rate + weight * error
            desk.dx_r[i] += weight * error
            desk.ddx_r[i] += weight * rate


@inner
def _command(rule: Rule, estimate: Vector, omega: Vector, wheels: Vector, desk: Desk, u: Vector) -> None:
    """Y pi_hat + K_D sigma, the base part turned into the body frame and freed of the wheels' gyroscopic torque."""
    for i in range(rule.first, u.shape[0]):
        k = i - rule.first
        u[i] = dot_product(desk.rows[i], estimate) + dot_product(rule.damping[k], desk.sigma)
    torque = body_torque_in(angles(desk.x), angles(u))
    spin = cross((omega[0], omega[1], omega[2]), (wheels[0], wheels[1], wheels[2]))
    u[3], u[4], u[5] = add(torque, spin)
    if rule.first:
        u[0], u[1], u[2] = 0.0, 0.0, 0.0
    else:
        u[0], u[1], u[2] = mul_t(get9(desk.places.bodies, ROOT, TURN), (u[0], u[1], u[2]))


@inner
def _lyapunov_function(tree: Tree, rule: Rule, estimate: Vector, desk: Desk) -> float:
    """sigma^T M_hat sigma / 2 + e^T Lambda K_D e, and sigma with the translation it entails."""
    full, first = desk.entailed, rule.first
    for i in range(full.shape[0]):
        full[i] = desk.sigma[i - first] if i >= first else 0.0
    move(tree, desk.still, desk.still, full, desk.places)
    momentum, energy = momentum_and_energy(estimate, desk.places)
    if first:
        mass = total_mass(estimate)
        for i in range(3):
            full[i] = -momentum[i] / mass
            energy += full[i] * momentum[i]
    value = 0.5 * energy
    for k in range(desk.error.shape[0]):
        value += rule.weight[k] * desk.error[k] * dot_product(rule.damping[k], desk.error)
    return value


@kernel
def fits(share: Vector, torque: Vector, force: Vector, wrench: Vector) -> bool:
    """True if a wrench (6,) is within the limits of wheels (k, 3), or of the three axes, and of thrusters (3,)."""
    for k in range(3):
        if not abs(wrench[k]) <= force[k]:
            return False
    for wheel in range(share.shape[0]):
        part = share[wheel, 0] * wrench[3] + share[wheel, 1] * wrench[4] + share[wheel, 2] * wrench[5]
        if not abs(part) <= torque[wheel]:
            return False
    return True
