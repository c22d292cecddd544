"""Forward dynamics of a free-flying tree: the articulated-body algorithm in body frames, order n.

Reference: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1, here with angular and linear parts apart:
momentum [n; f] = [A H; H^T M] [w; v], every joint along or about z, moments taken at the body's own origin.
"""

from __future__ import annotations

from space_robot_description.kernel.arrays import BASE, INERTIA, MASS, MOMENT, PARENT, PRISMATIC, RobotArrays
from space_robot_description.kernel.inverse_dynamics import place, twist_through
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.spatial import (
    Vec,
    add,
    cross,
    dot,
    factor,
    get3,
    get6,
    get9,
    mul_sym,
    mul_t,
    put3,
    scaled,
    solve,
)
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.articulated import AV, AW, UF, UN, A, D, E, F, H, M, N, P, R, V, W, pass_inward


@kernel
def forward_dynamics(
    robot: RobotArrays, y: Vector, force: Vec, torque: Vec, effort: Vector, work: Vector, dy: Vector
) -> None:
    """Accelerations of the base and the joints under applied forces.

    Args:
        robot: the robot.
        y: state [position(3), quaternion(4), joints(n), linear(3), angular(3), rates(n), ...], twist in the body frame.
        force: force on the base, body frame [N].
        torque: moment on the base about its origin, body frame [N m].
        effort: (n,) joint efforts [N m or N].
        work: (1+n, WORKSPACE) scratch.
        dy: receives d/dt of [linear, angular, rates] at the places of those in y.
    """
    bodies = robot.links.shape[0]
    _outward(robot, y, work)
    for body in range(bodies - 1, 0, -1):
        pass_inward(robot, body, effort[body - 1], y[12 + bodies + body - 1], work)
    _accelerate_base(force, torque, work, dy, 6 + bodies)
    for body in range(1, bodies):
        _accelerate_joint(robot, body, y[12 + bodies + body - 1], work, dy)


@inner
def _outward(robot: RobotArrays, y: Vector, work: Vector) -> None:
    """Placements and velocities from the base out; each body's own inertia and bias force."""
    bodies = robot.links.shape[0]
    for body in range(bodies):
        if body == 0:
            k = 6 + bodies
            v, w = (y[k], y[k + 1], y[k + 2]), (y[k + 3], y[k + 4], y[k + 5])
        else:
            place(robot, body, y[6 + body], work)
            above = robot.tree[body, PARENT]
            turn, shift, twist = get9(work, body, R), get3(work, body, P), (get3(work, above, W), get3(work, above, V))
            w, v = twist_through(turn, shift, twist, y[12 + bodies + body - 1], robot.tree[body, PRISMATIC])
        put3(work, body, W, w)
        put3(work, body, V, v)
        _own_inertia(robot.links, body, v, w, work)


@inner
def _own_inertia(links: Vector, body: int, v: Vec, w: Vec, work: Vector) -> None:
    """Inertia of one body alone, and the force that its motion without acceleration needs."""
    mass, h, inertia = links[body, MASS], get3(links, body, MOMENT), get6(links, body, INERTIA)
    for k in range(6):
        work[body, A + k] = inertia[k]
    put3(work, body, H, (0.0, -h[2], h[1]))
    put3(work, body, H + 3, (h[2], 0.0, -h[0]))
    put3(work, body, H + 6, (-h[1], h[0], 0.0))
    put3(work, body, M, (mass, 0.0, 0.0))
    put3(work, body, M + 3, (mass, 0.0, mass))
    linear = add(scaled(mass, v), cross(w, h))
    angular = add(mul_sym(inertia, w), cross(h, v))
    put3(work, body, N, add(cross(w, angular), cross(v, linear)))
    put3(work, body, F, cross(w, linear))


@inner
def _accelerate_base(force: Vec, torque: Vec, work: Vector, dy: Vector, k: int) -> None:
    """Solve [A H; H^T M] [dw; dv] = applied - bias through the Schur complement of M."""
    a, h = get6(work, BASE, A), get9(work, BASE, H)
    n = add(torque, scaled(-1.0, get3(work, BASE, N)))
    f = add(force, scaled(-1.0, get3(work, BASE, F)))
    lower = factor(get6(work, BASE, M))
    hx, hy, hz = (h[0], h[1], h[2]), (h[3], h[4], h[5]), (h[6], h[7], h[8])
    x, y, z = solve(lower, hx), solve(lower, hy), solve(lower, hz)
    schur = factor(
        (
            a[0] - dot(hx, x),
            a[1] - dot(hx, y),
            a[2] - dot(hx, z),
            a[3] - dot(hy, y),
            a[4] - dot(hy, z),
            a[5] - dot(hz, z),
        )
    )
    dw = solve(schur, (n[0] - dot(x, f), n[1] - dot(y, f), n[2] - dot(z, f)))
    dv = solve(lower, add(f, scaled(-1.0, mul_t(h, dw))))
    put3(work, BASE, AW, dw)
    put3(work, BASE, AV, dv)
    dy[k], dy[k + 1], dy[k + 2] = dv
    dy[k + 3], dy[k + 4], dy[k + 5] = dw


@inner
def _accelerate_joint(robot: RobotArrays, body: int, rate: float, work: Vector, dy: Vector) -> None:
    """Acceleration of a joint from that of the parent body."""
    above = robot.tree[body, PARENT]
    r, w, v = get9(work, body, R), get3(work, body, W), get3(work, body, V)
    dw_above = get3(work, above, AW)
    dw = mul_t(r, dw_above)
    dv = mul_t(r, add(get3(work, above, AV), cross(dw_above, get3(work, body, P))))
    if robot.tree[body, PRISMATIC]:
        dv = (dv[0] + rate * w[1], dv[1] - rate * w[0], dv[2])
    else:
        dw = (dw[0] + rate * w[1], dw[1] - rate * w[0], dw[2])
        dv = (dv[0] + rate * v[1], dv[1] - rate * v[0], dv[2])
    acceleration = work[body, D] * (work[body, E] - dot(get3(work, body, UN), dw) - dot(get3(work, body, UF), dv))
    if robot.tree[body, PRISMATIC]:
        dv = (dv[0], dv[1], dv[2] + acceleration)
    else:
        dw = (dw[0], dw[1], dw[2] + acceleration)
    put3(work, body, AW, dw)
    put3(work, body, AV, dv)
    dy[12 + robot.links.shape[0] + body - 1] = acceleration
