"""The control law: errors, Theta_r, regressor Y, command u, and the sigma that drives the parameter update.

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
from space_robot_control.laws.adaptive.kernel.workspace import Rule, Workspace
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.spatial import add, cross, get9, mul_t
from space_robot_msgs_py.interfaces import Vector


@kernel
def control(
    tree: Tree,
    rule: Rule,
    pi_hat: Vector,
    x: Vector,
    dx: Vector,
    omega: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    work: Workspace,
    u: Vector,
) -> float:
    """Write the command u (6+n,), errors and regressor; returns the Lyapunov function [J].

    Args:
        tree: geometry of the robot.
        rule: the law.
        pi_hat: (P,) pi_hat.
        x: (6+n,) of the state.
        dx: (6+n,) of the state.
        omega: (3,) body rate [rad/s].
        wheels: (3,) their momentum, body frame [N m s].
        q_d: (7+n,) of the reference.
        v_d: (6+n,) of the reference.
        a_d: (6+n,) of the reference.
        work: receives all but u.
        u: (6+n,) [force, torque, efforts], base part in the body frame.
    """
    _set_desired(rule, q_d, v_d, a_d, work)
    for i in range(x.shape[0]):
        work.x[i] = x[i] + rule.ahead * (dx[i] + rule.ahead / 2.0 * work.ddx_d[i])
        work.dx[i] = dx[i] + rule.ahead * work.ddx_d[i]
    _set_errors(rule, work)
    free_base = rule.first > 0
    slotine_li(tree, work.places, work.x, work.dx, work.dx_r, work.ddx_r, pi_hat, free_base, work.Y)
    _command(rule, pi_hat, omega, wheels, work, u)
    return _lyapunov_function(tree, rule, pi_hat, work)


@inner
def _set_desired(rule: Rule, q_d: Vector, v_d: Vector, a_d: Vector, work: Workspace) -> None:
    """Desired coordinates, with lead extrapolated by half a period: the reference is known at its stamp only."""
    coordinates(q_d, v_d, work.x_d, work.dx_d)
    second_derivative(q_d, v_d, a_d, work.x_d, work.dx_d, work.ddx_d)
    ahead, size = rule.ahead, work.x_d.shape[0]
    for i in range(size):
        ddx = work.ddx_d[i]
        jerk = (ddx - work.ddx_d_before[i]) / rule.period if work.ddx_d_before[size] else 0.0
        work.ddx_d_before[i] = ddx
        work.x_d[i] += ahead * (work.dx_d[i] + ahead / 2.0 * (ddx + ahead / 3.0 * jerk))
        work.dx_d[i] += ahead * (ddx + ahead / 2.0 * jerk)
        work.ddx_d[i] += ahead * jerk
    work.ddx_d_before[size] = 1.0


@inner
def _set_errors(rule: Rule, work: Workspace) -> None:
    """Errors, sigma, Theta_r' and Theta_r''; the unactuated part of the latter two is zero."""
    for i in range(rule.first):
        work.dx_r[i], work.ddx_r[i] = 0.0, 0.0
    for i in range(rule.first, work.x.shape[0]):
        k = i - rule.first
        off = work.x_d[i] - work.x[i]
        error = short_way_in(off) if i in (YAW, ROLL) else off
        weight, rate = rule.lambda_[k], work.dx_d[i] - work.dx[i]
        work.e[k] = error
        work.dx_r[i], work.ddx_r[i] = work.dx_d[i], work.ddx_d[i]
        if rule.on_velocity:
            work.sigma[k] = weight * rate + error
        else:
            work.sigma[k] = rate + weight * error
            work.dx_r[i] += weight * error
            work.ddx_r[i] += weight * rate


@inner
def _command(rule: Rule, pi_hat: Vector, omega: Vector, wheels: Vector, work: Workspace, u: Vector) -> None:
    """Y pi_hat + K_D sigma, the base part turned into the body frame and freed of the wheels' gyroscopic torque."""
    for i in range(rule.first, u.shape[0]):
        k = i - rule.first
        u[i] = dot_product(work.Y[i], pi_hat) + dot_product(rule.k_d[k], work.sigma)
    torque = body_torque_in(angles(work.x), angles(u))
    spin = cross((omega[0], omega[1], omega[2]), (wheels[0], wheels[1], wheels[2]))
    u[3], u[4], u[5] = add(torque, spin)
    if rule.first:
        u[0], u[1], u[2] = 0.0, 0.0, 0.0
    else:
        u[0], u[1], u[2] = mul_t(get9(work.places.bodies, ROOT, TURN), (u[0], u[1], u[2]))


@inner
def _lyapunov_function(tree: Tree, rule: Rule, pi_hat: Vector, work: Workspace) -> float:
    """sigma^T M_hat sigma / 2 + e^T Lambda K_D e, and sigma with eliminated translation."""
    full, first = work.sigma_full, rule.first
    for i in range(full.shape[0]):
        full[i] = work.sigma[i - first] if i >= first else 0.0
    move(tree, work.zero, work.zero, full, work.places)
    momentum, energy = momentum_and_energy(pi_hat, work.places)
    if first:
        mass = total_mass(pi_hat)
        for i in range(3):
            full[i] = -momentum[i] / mass
            energy += full[i] * momentum[i]
    value = 0.5 * energy
    for k in range(work.e.shape[0]):
        value += rule.lambda_[k] * work.e[k] * dot_product(rule.k_d[k], work.e)
    return value
