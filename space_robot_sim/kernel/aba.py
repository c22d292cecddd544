"""Forward dynamics of a free-flying tree: the articulated-body algorithm in body frames, order n.

Reference: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1, here with angular and linear parts apart:
momentum [n; f] = [A H; H^T M] [w; v], every joint along or about z, moments taken at the body's own origin.
"""

from __future__ import annotations

import math

from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.arrays import BASE, INERTIA, MASS, MOMENT, ORIGIN, PARENT, PRISMATIC, ROTATION, RobotArrays
from space_robot_sim.kernel.jit import constants, inner, kernel
from space_robot_sim.kernel.spatial import (
    Mat,
    Sym,
    Vec,
    add,
    cross,
    dot,
    factor,
    get3,
    get6,
    get9,
    mul,
    mul_sym,
    mul_t,
    put3,
    scaled,
    solve,
    turned,
    turned_sym,
)

# Columns of the workspace, one row per body. _A, _H, _M: articulated inertia; _N, _F: bias moment and force;
# _UN, _UF, _D, _E: joint column of the inertia, 1/its diagonal, joint effort left; _AW, _AV: spatial acceleration.
_R, _P, _W, _V, _A, _H, _M, _N, _F = constants(0, 9, 12, 15, 18, 24, 33, 39, 42)
_UN, _UF, _D, _E, _AW, _AV = constants(45, 48, 51, 52, 53, 56)
WORKSPACE = 60


@kernel
def forward_dynamics(
    robot: RobotArrays, y: Vector, wrench: Vec, torque: Vec, effort: Vector, work: Vector, dy: Vector
) -> None:
    """Accelerations of the base and the joints under applied forces.

    Args:
        robot: the robot.
        y: state [position(3), quaternion(4), joints(n), linear(3), angular(3), rates(n), ...], twist in the body frame.
        wrench: force on the base, body frame [N].
        torque: moment on the base about its origin, body frame [N m].
        effort: (n,) joint efforts [N m or N].
        work: (1+n, WORKSPACE) scratch.
        dy: receives d/dt of [linear, angular, rates] at the places of those in y.
    """
    bodies = robot.links.shape[0]
    _outward(robot, y, work)
    for body in range(bodies - 1, 0, -1):
        _inward(robot, body, effort[body - 1], y[12 + bodies + body - 1], work)
    _accelerate_base(wrench, torque, work, dy, 6 + bodies)
    for body in range(1, bodies):
        _accelerate_joint(robot, body, y[12 + bodies + body - 1], work, dy)


@inner
def place(robot: RobotArrays, body: int, joint: float, out: Vector) -> None:
    """Write into row ``body`` of out: rotation to the parent (9) and origin in the parent (3) at a joint position."""
    links = robot.links
    m, origin = get9(links, body, ROTATION), get3(links, body, ORIGIN)
    if robot.tree[body, PRISMATIC]:
        origin = add(origin, scaled(joint, (m[2], m[5], m[8])))
    else:
        c, s = math.cos(joint), math.sin(joint)
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
    for k in range(9):
        out[body, _R + k] = m[k]
    put3(out, body, _P, origin)


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
            turn, w_above = get9(work, body, _R), get3(work, above, _W)
            w = mul_t(turn, w_above)
            v = mul_t(turn, add(get3(work, above, _V), cross(w_above, get3(work, body, _P))))
            rate = y[12 + bodies + body - 1]
            if robot.tree[body, PRISMATIC]:
                v = (v[0], v[1], v[2] + rate)
            else:
                w = (w[0], w[1], w[2] + rate)
        put3(work, body, _W, w)
        put3(work, body, _V, v)
        _own_inertia(robot.links, body, v, w, work)


@inner
def _own_inertia(links: Vector, body: int, v: Vec, w: Vec, work: Vector) -> None:
    """Inertia of one body alone, and the force that its motion without acceleration needs."""
    mass, h, inertia = links[body, MASS], get3(links, body, MOMENT), get6(links, body, INERTIA)
    for k in range(6):
        work[body, _A + k] = inertia[k]
    put3(work, body, _H, (0.0, -h[2], h[1]))
    put3(work, body, _H + 3, (h[2], 0.0, -h[0]))
    put3(work, body, _H + 6, (-h[1], h[0], 0.0))
    put3(work, body, _M, (mass, 0.0, 0.0))
    put3(work, body, _M + 3, (mass, 0.0, mass))
    linear = add(scaled(mass, v), cross(w, h))
    angular = add(mul_sym(inertia, w), cross(h, v))
    put3(work, body, _N, add(cross(w, angular), cross(v, linear)))
    put3(work, body, _F, cross(w, linear))


@inner
def _inward(robot: RobotArrays, body: int, effort: float, rate: float, work: Vector) -> None:
    """Hand the articulated inertia and bias force of a body, seen through its joint, to its parent."""
    above = robot.tree[body, PARENT]
    a, h, m = get6(work, body, _A), get9(work, body, _H), get6(work, body, _M)
    n, f = get3(work, body, _N), get3(work, body, _F)
    w, v = get3(work, body, _W), get3(work, body, _V)
    if robot.tree[body, PRISMATIC]:
        un, uf = (h[2], h[5], h[8]), (m[2], m[4], m[5])
        d, e = 1.0 / uf[2], effort - f[2]
        bias_w, bias_v = (0.0, 0.0, 0.0), (rate * w[1], -rate * w[0], 0.0)
    else:
        un, uf = (a[2], a[4], a[5]), (h[6], h[7], h[8])
        d, e = 1.0 / un[2], effort - n[2]
        bias_w, bias_v = (rate * w[1], -rate * w[0], 0.0), (rate * v[1], -rate * v[0], 0.0)
    put3(work, body, _UN, un)
    put3(work, body, _UF, uf)
    work[body, _D], work[body, _E] = d, e
    a, h, m = _less_outer(a, d, un), _less_product(h, d, un, uf), _less_outer(m, d, uf)
    n = add(add(n, mul_sym(a, bias_w)), add(mul(h, bias_v), scaled(d * e, un)))
    f = add(add(f, mul_t(h, bias_w)), add(mul_sym(m, bias_v), scaled(d * e, uf)))
    _add_to_parent(a, h, m, n, f, work, body, above)


@inner
def _less_outer(s: Sym, d: float, u: Vec) -> Sym:
    """S - d u u^T."""
    x, y, z = d * u[0], d * u[1], d * u[2]
    return s[0] - x * u[0], s[1] - x * u[1], s[2] - x * u[2], s[3] - y * u[1], s[4] - y * u[2], s[5] - z * u[2]


@inner
def _less_product(m: Mat, d: float, a: Vec, b: Vec) -> Mat:
    """M - d a b^T."""
    x, y, z = d * a[0], d * a[1], d * a[2]
    return (
        m[0] - x * b[0],
        m[1] - x * b[1],
        m[2] - x * b[2],
        m[3] - y * b[0],
        m[4] - y * b[1],
        m[5] - y * b[2],
        m[6] - z * b[0],
        m[7] - z * b[1],
        m[8] - z * b[2],
    )


@inner
def _add_to_parent(a: Sym, h: Mat, m: Sym, n: Vec, f: Vec, work: Vector, body: int, above: int) -> None:
    """Turn inertia and bias force into the parent's frame, move them to its origin, add them to its own."""
    r, p = get9(work, body, _R), get3(work, body, _P)
    a, h, m, n, f = turned_sym(r, a), turned(r, h), turned_sym(r, m), mul(r, n), mul(r, f)
    # H + [p] M, column by column of the symmetric M.
    c0, c1, c2 = cross(p, (m[0], m[1], m[2])), cross(p, (m[1], m[3], m[4])), cross(p, (m[2], m[4], m[5]))
    g = (
        h[0] + c0[0],
        h[1] + c1[0],
        h[2] + c2[0],
        h[3] + c0[1],
        h[4] + c1[1],
        h[5] + c2[1],
        h[6] + c0[2],
        h[7] + c1[2],
        h[8] + c2[2],
    )
    # A - G [p] + [p] H^T: row i of [p] H^T is column i of -(H [p]), and H [p] has the rows of H crossed with p.
    g0, g1, g2 = cross((g[0], g[1], g[2]), p), cross((g[3], g[4], g[5]), p), cross((g[6], g[7], g[8]), p)
    h0, h1, h2 = cross((h[0], h[1], h[2]), p), cross((h[3], h[4], h[5]), p), cross((h[6], h[7], h[8]), p)
    work[above, _A] += a[0] - g0[0] - h0[0]
    work[above, _A + 1] += a[1] - g0[1] - h1[0]
    work[above, _A + 2] += a[2] - g0[2] - h2[0]
    work[above, _A + 3] += a[3] - g1[1] - h1[1]
    work[above, _A + 4] += a[4] - g1[2] - h2[1]
    work[above, _A + 5] += a[5] - g2[2] - h2[2]
    for k in range(9):
        work[above, _H + k] += g[k]
    for k in range(6):
        work[above, _M + k] += m[k]
    put3(work, above, _N, add(get3(work, above, _N), add(n, cross(p, f))))
    put3(work, above, _F, add(get3(work, above, _F), f))


@inner
def _accelerate_base(force: Vec, torque: Vec, work: Vector, dy: Vector, k: int) -> None:
    """Solve [A H; H^T M] [dw; dv] = applied - bias through the Schur complement of M."""
    a, h = get6(work, BASE, _A), get9(work, BASE, _H)
    n = add(torque, scaled(-1.0, get3(work, BASE, _N)))
    f = add(force, scaled(-1.0, get3(work, BASE, _F)))
    lower = factor(get6(work, BASE, _M))
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
    put3(work, BASE, _AW, dw)
    put3(work, BASE, _AV, dv)
    dy[k], dy[k + 1], dy[k + 2] = dv
    dy[k + 3], dy[k + 4], dy[k + 5] = dw


@inner
def _accelerate_joint(robot: RobotArrays, body: int, rate: float, work: Vector, dy: Vector) -> None:
    """Acceleration of a joint from that of the parent body."""
    above = robot.tree[body, PARENT]
    r, w, v = get9(work, body, _R), get3(work, body, _W), get3(work, body, _V)
    dw_above = get3(work, above, _AW)
    dw = mul_t(r, dw_above)
    dv = mul_t(r, add(get3(work, above, _AV), cross(dw_above, get3(work, body, _P))))
    if robot.tree[body, PRISMATIC]:
        dv = (dv[0] + rate * w[1], dv[1] - rate * w[0], dv[2])
    else:
        dw = (dw[0] + rate * w[1], dw[1] - rate * w[0], dw[2])
        dv = (dv[0] + rate * v[1], dv[1] - rate * v[0], dv[2])
    acceleration = work[body, _D] * (work[body, _E] - dot(get3(work, body, _UN), dw) - dot(get3(work, body, _UF), dv))
    if robot.tree[body, PRISMATIC]:
        dv = (dv[0], dv[1], dv[2] + acceleration)
    else:
        dw = (dw[0], dw[1], dw[2] + acceleration)
    put3(work, body, _AW, dw)
    put3(work, body, _AV, dv)
    dy[12 + robot.links.shape[0] + body - 1] = acceleration
