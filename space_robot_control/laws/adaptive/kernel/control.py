"""The command that answers a state: errors, Theta_r, regressor, u, and the sigma that moves the parameters.

Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (31)-(38), (42); the words are those of ``laws.adaptive``.
"""

from __future__ import annotations

from space_robot_control.laws.adaptive.kernel.euler import (
    ROLL,
    YAW,
    angles,
    body_torque_in,
    coordinates,
    second_derivative,
    short_way_in,
)
from space_robot_control.laws.adaptive.kernel.least_squares import dot_product
from space_robot_control.laws.adaptive.kernel.motion import move
from space_robot_control.laws.adaptive.kernel.regressor import momentum_and_energy, slotine_li, total_mass
from space_robot_control.laws.adaptive.kernel.tree import ROOT, TURN, Tree
from space_robot_control.laws.adaptive.kernel.workspace import Desk, Rule
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.spatial import add, cross, get9, mul_t
from space_robot_msgs_py.interfaces import Vector


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
