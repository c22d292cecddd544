"""The regression of a period: regressor and generalised force in its middle, given the applied command.

Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (39)-(41).
"""

from __future__ import annotations

from space_robot_control.laws.adaptive.kernel.euler import PITCH, ROLL, YAW, angles, generalised_torque_in, short_way_in
from space_robot_control.laws.adaptive.kernel.regressor import slotine_li
from space_robot_control.laws.adaptive.kernel.tree import ROOT, TURN, Tree
from space_robot_control.laws.adaptive.kernel.workspace import ACCELEROMETER, MODEL, PeriodStart, Rule, Workspace
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix
from space_robot_description.kernel.spatial import Vec, add, cross, get9, mul, scaled, sub
from space_robot_msgs_py.interfaces import Vector


@kernel
def regression(
    tree: Tree,
    rule: Rule,
    pi_hat: Vector,
    start: PeriodStart,
    x: Vector,
    dx: Vector,
    q: Vector,
    v: Vector,
    effort: Vector,
    acceleration: Vector,
    work: Workspace,
    tau: Vector,
) -> None:
    """Write the regressor in the middle of a period into work.Y, the generalised force into tau, to unit noise.

    Args:
        tree: geometry of the robot.
        rule: the law.
        pi_hat: (P,) pi_hat.
        start: of the period.
        x: (6+n,) at its end.
        dx: (6+n,) at its end.
        q: (7+n,) of the state at its end.
        v: (6+n,) of the state at its end.
        effort: (n,) of the joints over it.
        acceleration: (3,) of the base, as an accelerometer reads it.
        work: receives the regressor, rows (6+n, P).
        tau: (6+n,) generalised forces; those before ``rule.first`` mean nothing.
    """
    for i in range(x.shape[0]):
        step = x[i] - start.x[i]
        work.x[i] = start.x[i] + 0.5 * (short_way_in(step) if i in (YAW, ROLL) else step)
        work.dx[i] = 0.5 * (start.dx[i] + dx[i])
        work.ddx_r[i] = (dx[i] - start.dx[i]) / rule.period
    if rule.source == ACCELEROMETER:
        read = (acceleration[0], acceleration[1], acceleration[2])
        work.ddx_r[0], work.ddx_r[1], work.ddx_r[2] = mul(matrix(attitude(q)), read)
    elif rule.source == MODEL:
        work.ddx_r[0], work.ddx_r[1], work.ddx_r[2] = 0.0, 0.0, 0.0
    free_base = rule.source == MODEL
    slotine_li(tree, work.places, work.x, work.dx, work.dx, work.ddx_r, pi_hat, free_base, work.Y)
    _applied(start, (v[3], v[4], v[5]), effort, work, tau)
    for row in range(rule.first, tau.shape[0]):
        accuracy = 1.0 / rule.noise[row - rule.first]
        tau[row] *= accuracy
        for column in range(pi_hat.shape[0]):
            work.Y[row, column] *= accuracy


@inner
def _applied(start: PeriodStart, omega: Vec, effort: Vector, work: Workspace, tau: Vector) -> None:
    """The generalised forces over the period, less what turns the wheels."""
    wrench, wheels = start.wrench, (start.wheels[0], start.wheels[1], start.wheels[2])
    mean = scaled(0.5, add((start.omega[0], start.omega[1], start.omega[2]), omega))
    torque = sub((wrench[3], wrench[4], wrench[5]), cross(mean, wheels))
    turn = get9(work.places.bodies, ROOT, TURN)
    tau[0], tau[1], tau[2] = mul(turn, (wrench[0], wrench[1], wrench[2]))
    tau[ROLL], tau[PITCH], tau[YAW] = generalised_torque_in(angles(work.x), torque)
    for joint in range(effort.shape[0]):
        tau[6 + joint] = effort[joint]
