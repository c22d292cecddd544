"""Inverse dynamics of a free-flying tree: recursive Newton-Euler in body frames, the forces of a motion in order n.

Reference: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1, here with angular and linear parts apart:
momentum [n; f] = [A H; H^T M] [w; v], every joint along or about z, moments taken at the body's own origin.
"""

from __future__ import annotations

from space_robot_description.kernel.arrays import (
    BASE,
    INERTIA,
    MASS,
    MOMENT,
    ORIGIN,
    PARENT,
    PRISMATIC,
    ROTATION,
    RobotArrays,
)
from space_robot_description.kernel.coupling import COORDINATE, MULTIPLIER, POSITION, RATE, of_joint
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.spatial import (
    Mat,
    Vec,
    add,
    cross,
    get3,
    get6,
    get9,
    mul,
    mul_sym,
    mul_t,
    put3,
    put9,
    scaled,
)
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos

Motion = tuple[Vec, Vec, Vec, Vec]

# Columns of the workspace, one row per body: placement as in `links`, twist, its derivative, moment and force.
_W, _V, _DW, _DV, _N, _F, MOTION_SIZE = constants(12, 15, 18, 21, 24, 27, 30)


@inner
def place(robot: RobotArrays, body: int, joint: float, out: Vector) -> None:
    """Write into row ``body`` of out: rotation to the parent (9) and origin in the parent (3) at a joint position."""
    links = robot.links
    m, origin = get9(links, body, ROTATION), get3(links, body, ORIGIN)
    if robot.tree[body, PRISMATIC]:
        origin = add(origin, scaled(joint, (m[2], m[5], m[8])))
    else:
        s, c = sincos(joint)
        m = (
            c * m[0] + s * m[1],
            c * m[1] - s * m[0],
            m[2],
            c * m[3] + s * m[4],
            c * m[4] - s * m[3],
            m[5],
            c * m[6] + s * m[7],
            c * m[7] - s * m[6],
            m[8],
        )
    put9(out, body, ROTATION, m)
    put3(out, body, ORIGIN, origin)


@kernel
def inverse_dynamics(robot: RobotArrays, q: Vector, v: Vector, a: Vector, work: Vector, u: Vector) -> None:
    """Write the generalised force M(q) a + c(q, v), base part in the body frame.

    Args:
        robot: the robot; its motors are not looked at.
        q: (7+n,) configuration; place and attitude of the base do not enter.
        v: (6+n,) velocity, base twist in the body frame.
        a: (6+n,) derivative of the components of v.
        work: (1+N, MOTION_SIZE) scratch.
        u: (6+n,) written: force and moment on the base, joint efforts.
    """
    bodies, coupling = robot.links.shape[0], robot.coupling
    for body in range(bodies):
        if body == 0:
            w, linear = (v[3], v[4], v[5]), (v[0], v[1], v[2])
            dw, dv = (a[3], a[4], a[5]), (a[0], a[1], a[2])
        else:
            place(robot, body, of_joint(coupling, q, 7, body - 1, POSITION), work)
            rate, rate_dot = of_joint(coupling, v, 6, body - 1, RATE), of_joint(coupling, a, 6, body - 1, RATE)
            w, linear, dw, dv = _through_joint(robot, body, rate, rate_dot, work)
        put3(work, body, _W, w)
        put3(work, body, _V, linear)
        put3(work, body, _DW, dw)
        put3(work, body, _DV, dv)
        _own_force(robot.links, body, work)
    if coupling.shape[0]:
        for i in range(6, u.shape[0]):
            u[i] = 0.0
    for body in range(bodies - 1, 0, -1):
        effort = work[body, _F + 2] if robot.tree[body, PRISMATIC] else work[body, _N + 2]
        if coupling.shape[0]:
            u[6 + int(coupling[body - 1, COORDINATE])] += coupling[body - 1, MULTIPLIER] * effort
        else:
            u[5 + body] = effort
        _add_to_parent(body, robot.tree[body, PARENT], work)
    u[0], u[1], u[2] = get3(work, BASE, _F)
    u[3], u[4], u[5] = get3(work, BASE, _N)


@inner
def twist_through(turn: Mat, shift: Vec, above: tuple[Vec, Vec], rate: float, prismatic: int) -> tuple[Vec, Vec]:
    """Twist w, v of a body from that of its parent, its placement as of ``place`` and the rate of its joint."""
    w, v = mul_t(turn, above[0]), mul_t(turn, add(above[1], cross(above[0], shift)))
    if prismatic:
        return w, (v[0], v[1], v[2] + rate)
    return (w[0], w[1], w[2] + rate), v


@inner
def _through_joint(
    robot: RobotArrays, body: int, rate: float, rate_dot: float, work: Vector
) -> tuple[Vec, Vec, Vec, Vec]:
    """Twist of a body and its derivative, from those of its parent: w, v, w', v'."""
    above = robot.tree[body, PARENT]
    r, p = get9(work, body, ROTATION), get3(work, body, ORIGIN)
    w_above, dw_above = get3(work, above, _W), get3(work, above, _DW)
    w, dw = mul_t(r, w_above), mul_t(r, dw_above)
    v = mul_t(r, add(get3(work, above, _V), cross(w_above, p)))
    dv = mul_t(r, add(get3(work, above, _DV), cross(dw_above, p)))
    if robot.tree[body, PRISMATIC]:
        dv = (dv[0] + rate * w[1], dv[1] - rate * w[0], dv[2] + rate_dot)
        v = (v[0], v[1], v[2] + rate)
    else:
        dw = (dw[0] + rate * w[1], dw[1] - rate * w[0], dw[2] + rate_dot)
        dv = (dv[0] + rate * v[1], dv[1] - rate * v[0], dv[2])
        w = (w[0], w[1], w[2] + rate)
    return w, v, dw, dv


@inner
def _own_force(links: Vector, body: int, work: Vector) -> None:
    """Force and moment that the motion of one body alone needs: the rate of its momentum."""
    mass, h, inertia = links[body, MASS], get3(links, body, MOMENT), get6(links, body, INERTIA)
    w, v, dw, dv = get3(work, body, _W), get3(work, body, _V), get3(work, body, _DW), get3(work, body, _DV)
    linear = add(scaled(mass, v), cross(w, h))
    angular = add(mul_sym(inertia, w), cross(h, v))
    put3(work, body, _F, add(add(scaled(mass, dv), cross(dw, h)), cross(w, linear)))
    put3(work, body, _N, add(add(mul_sym(inertia, dw), cross(h, dv)), add(cross(w, angular), cross(v, linear))))


@inner
def _add_to_parent(body: int, above: int, work: Vector) -> None:
    """Hand force and moment of a body to its parent."""
    r, n, f = get9(work, body, ROTATION), get3(work, body, _N), get3(work, body, _F)
    force = mul(r, f)
    put3(work, above, _F, add(get3(work, above, _F), force))
    put3(work, above, _N, add(get3(work, above, _N), add(mul(r, n), cross(get3(work, body, ORIGIN), force))))
