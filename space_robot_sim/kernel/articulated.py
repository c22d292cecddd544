"""The inward half of the articulated-body algorithm: what a body passes to its parent through its joint."""

from __future__ import annotations

from space_robot_description.kernel.arrays import LOCKED, PARENT, PRISMATIC, RobotArrays
from space_robot_description.kernel.jit import constants, inner
from space_robot_description.kernel.spatial import (
    Mat,
    Sym,
    Vec,
    add,
    cross,
    get3,
    get6,
    get9,
    mul,
    mul_sym,
    put3,
    scaled,
    turned,
    turned_plane,
    turned_rows,
    turned_sym,
)
from space_robot_msgs_py.interfaces import Vector

Passed = tuple[Sym, Mat, Sym, Vec, Vec]

# Columns of the workspace, one row per body. R, P: rotation to the parent and origin in it; W, V: twist;
# A, H, M: articulated inertia; N, F: bias moment and force;
# UN, UF, D, E: joint column of the inertia, 1/its diagonal, joint effort left; AW, AV: spatial acceleration.
R, P, W, V, A, H, M, N, F = constants(0, 9, 12, 15, 18, 24, 33, 39, 42)
UN, UF, D, E, AW, AV = constants(45, 48, 51, 52, 53, 56)
WORKSPACE = 60


@inner
def pass_inward(robot: RobotArrays, body: int, effort: float, rate: float, work: Vector) -> None:
    """Hand the articulated inertia and bias force of a body, seen through its joint, to its parent."""
    if robot.tree[body, LOCKED]:
        a, h, m, n, f = _through_brake(body, work)
    elif robot.tree[body, PRISMATIC]:
        a, h, m, n, f = _through_slide(body, effort, rate, work)
    else:
        a, h, m, n, f = _through_hinge(body, effort, rate, work)
    _add_to_parent(a, h, m, n, f, work, body, robot.tree[body, PARENT])


@inner
def _through_brake(body: int, work: Vector) -> Passed:
    """What a joint passes on whose rate is zero and stays so: everything."""
    a, h, m = get6(work, body, A), get9(work, body, H), get6(work, body, M)
    put3(work, body, UN, (0.0, 0.0, 0.0))
    put3(work, body, UF, (0.0, 0.0, 0.0))
    work[body, D], work[body, E] = 0.0, 0.0
    r = get9(work, body, R)
    return turned_sym(r, a), turned(r, h), turned_sym(r, m), mul(r, get3(work, body, N)), mul(r, get3(work, body, F))


@inner
def _through_slide(body: int, effort: float, rate: float, work: Vector) -> Passed:
    """What a sliding joint passes on, turned into the parent's frame."""
    a, h, m = get6(work, body, A), get9(work, body, H), get6(work, body, M)
    n, f, w = get3(work, body, N), get3(work, body, F), get3(work, body, W)
    un, uf = (h[2], h[5], h[8]), (m[2], m[4], m[5])
    d, e = 1.0 / uf[2], effort - f[2]
    put3(work, body, UN, un)
    put3(work, body, UF, uf)
    work[body, D], work[body, E] = d, e
    a, h, m = _less_outer(a, d, un), _less_product(h, d, un, uf), _less_outer(m, d, uf)
    bias = (rate * w[1], -rate * w[0], 0.0)
    n = add(n, add(mul(h, bias), scaled(d * e, un)))
    f = add(f, add(mul_sym(m, bias), scaled(d * e, uf)))
    r = get9(work, body, R)
    return turned_sym(r, a), turned(r, h), turned_sym(r, m), mul(r, n), mul(r, f)


@inner
def _through_hinge(body: int, effort: float, rate: float, work: Vector) -> Passed:
    """What a hinge passes on: the third row and column of A and the third row of H vanish, and are left out."""
    a, h, m = get6(work, body, A), get9(work, body, H), get6(work, body, M)
    n, f, w, v = get3(work, body, N), get3(work, body, F), get3(work, body, W), get3(work, body, V)
    un, uf = (a[2], a[4], a[5]), (h[6], h[7], h[8])
    d, e = 1.0 / un[2], effort - n[2]
    put3(work, body, UN, un)
    put3(work, body, UF, uf)
    work[body, D], work[body, E] = d, e
    x, y, z = d * un[0], d * un[1], d * e
    xx, xy, yy = a[0] - x * un[0], a[1] - x * un[1], a[3] - y * un[1]
    hx = (h[0] - x * uf[0], h[1] - x * uf[1], h[2] - x * uf[2])
    hy = (h[3] - y * uf[0], h[4] - y * uf[1], h[5] - y * uf[2])
    m = _less_outer(m, d, uf)
    wx, wy, vx, vy = rate * w[1], -rate * w[0], rate * v[1], -rate * v[0]
    n = (
        n[0] + xx * wx + xy * wy + hx[0] * vx + hx[1] * vy + z * un[0],
        n[1] + xy * wx + yy * wy + hy[0] * vx + hy[1] * vy + z * un[1],
        effort,
    )
    f = (
        f[0] + hx[0] * wx + hy[0] * wy + m[0] * vx + m[1] * vy + z * uf[0],
        f[1] + hx[1] * wx + hy[1] * wy + m[1] * vx + m[3] * vy + z * uf[1],
        f[2] + hx[2] * wx + hy[2] * wy + m[2] * vx + m[4] * vy + z * uf[2],
    )
    r = get9(work, body, R)
    return turned_plane(r, xx, xy, yy), turned_rows(r, hx, hy), turned_sym(r, m), mul(r, n), mul(r, f)


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
    """Move inertia and bias force, in the parent's frame already, to its origin and add them to its own."""
    p = get3(work, body, P)
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
    work[above, A] += a[0] - g0[0] - h0[0]
    work[above, A + 1] += a[1] - g0[1] - h1[0]
    work[above, A + 2] += a[2] - g0[2] - h2[0]
    work[above, A + 3] += a[3] - g1[1] - h1[1]
    work[above, A + 4] += a[4] - g1[2] - h2[1]
    work[above, A + 5] += a[5] - g2[2] - h2[2]
    for k in range(9):
        work[above, H + k] += g[k]
    for k in range(6):
        work[above, M + k] += m[k]
    put3(work, above, N, add(get3(work, above, N), add(n, cross(p, f))))
    put3(work, above, F, add(get3(work, above, F), f))
