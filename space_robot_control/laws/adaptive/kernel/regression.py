"""What a period teaches: regressor and generalised force in its middle, if it is known what acted.

Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (39)-(41).
"""

from __future__ import annotations

from space_robot_control.laws.adaptive.kernel.euler import PITCH, ROLL, YAW, angles, generalised_torque_in, short_way_in
from space_robot_control.laws.adaptive.kernel.regressor import slotine_li
from space_robot_control.laws.adaptive.kernel.tree import ROOT, TURN, Tree
from space_robot_control.laws.adaptive.kernel.workspace import ACCELEROMETER, MODEL, Desk, Held, Rule
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix
from space_robot_description.kernel.spatial import Vec, add, cross, get9, mul, scaled, sub
from space_robot_msgs_py.interfaces import Vector


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
        desk.ddx_r[0], desk.ddx_r[1], desk.ddx_r[2] = mul(matrix(attitude(q)), read)
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
def _acted(held: Held, omega: Vec, effort: Vector, desk: Desk, values: Vector) -> None:
    """The generalised forces over the period, less what turns the wheels."""
    wrench, wheels = held.wrench, (held.wheels[0], held.wheels[1], held.wheels[2])
    mean = scaled(0.5, add((held.omega[0], held.omega[1], held.omega[2]), omega))
    torque = sub((wrench[3], wrench[4], wrench[5]), cross(mean, wheels))
    turn = get9(desk.places.bodies, ROOT, TURN)
    values[0], values[1], values[2] = mul(turn, (wrench[0], wrench[1], wrench[2]))
    values[ROLL], values[PITCH], values[YAW] = generalised_torque_in(angles(desk.x), torque)
    for joint in range(effort.shape[0]):
        values[6 + joint] = effort[joint]
