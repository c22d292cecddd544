"""Three-vectors, symmetric and general 3x3 matrices as tuples of scalars, which compiled code keeps in registers.

A symmetric matrix is (xx, xy, xz, yy, yz, zz); a general one is its nine elements row by row.
"""

from __future__ import annotations

from space_robot_description.kernel.jit import inner
from space_robot_msgs_py.interfaces import Vector

Vec = tuple[float, float, float]
Sym = tuple[float, float, float, float, float, float]
Mat = tuple[float, float, float, float, float, float, float, float, float]


@inner
def get3(rows: Vector, i: int, k: int) -> Vec:
    """Three numbers of row i from column k."""
    return rows[i, k], rows[i, k + 1], rows[i, k + 2]


@inner
def get6(rows: Vector, i: int, k: int) -> Sym:
    """Six numbers of row i from column k."""
    return rows[i, k], rows[i, k + 1], rows[i, k + 2], rows[i, k + 3], rows[i, k + 4], rows[i, k + 5]


@inner
def get9(rows: Vector, i: int, k: int) -> Mat:
    """Nine numbers of row i from column k."""
    return (
        rows[i, k],
        rows[i, k + 1],
        rows[i, k + 2],
        rows[i, k + 3],
        rows[i, k + 4],
        rows[i, k + 5],
        rows[i, k + 6],
        rows[i, k + 7],
        rows[i, k + 8],
    )


@inner
def put3(rows: Vector, i: int, k: int, a: Vec) -> None:
    """Store three numbers in row i from column k."""
    rows[i, k], rows[i, k + 1], rows[i, k + 2] = a


@inner
def put9(rows: Vector, i: int, k: int, m: Mat) -> None:
    """Store nine numbers in row i from column k."""
    for j in range(9):
        rows[i, k + j] = m[j]


@inner
def add(a: Vec, b: Vec) -> Vec:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inner
def sub(a: Vec, b: Vec) -> Vec:
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner
def scaled(s: float, a: Vec) -> Vec:
    """A vector times a number."""
    return s * a[0], s * a[1], s * a[2]


@inner
def dot(a: Vec, b: Vec) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def cross(a: Vec, b: Vec) -> Vec:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inner
def mul(m: Mat, a: Vec) -> Vec:
    """M a."""
    return (
        m[0] * a[0] + m[1] * a[1] + m[2] * a[2],
        m[3] * a[0] + m[4] * a[1] + m[5] * a[2],
        m[6] * a[0] + m[7] * a[1] + m[8] * a[2],
    )


@inner
def mul_t(m: Mat, a: Vec) -> Vec:
    """M^T a."""
    return (
        m[0] * a[0] + m[3] * a[1] + m[6] * a[2],
        m[1] * a[0] + m[4] * a[1] + m[7] * a[2],
        m[2] * a[0] + m[5] * a[1] + m[8] * a[2],
    )


@inner
def mul_sym(s: Sym, a: Vec) -> Vec:
    """S a of a symmetric S."""
    return (
        s[0] * a[0] + s[1] * a[1] + s[2] * a[2],
        s[1] * a[0] + s[3] * a[1] + s[4] * a[2],
        s[2] * a[0] + s[4] * a[1] + s[5] * a[2],
    )


@inner
def product(a: Mat, b: Mat) -> Mat:
    """A B."""
    c0 = mul(a, (b[0], b[3], b[6]))
    c1 = mul(a, (b[1], b[4], b[7]))
    c2 = mul(a, (b[2], b[5], b[8]))
    return c0[0], c1[0], c2[0], c0[1], c1[1], c2[1], c0[2], c1[2], c2[2]


@inner
def turned(r: Mat, m: Mat) -> Mat:
    """R M R^T."""
    rows = product(r, m)
    c0 = mul(rows, (r[0], r[1], r[2]))
    c1 = mul(rows, (r[3], r[4], r[5]))
    c2 = mul(rows, (r[6], r[7], r[8]))
    return c0[0], c1[0], c2[0], c0[1], c1[1], c2[1], c0[2], c1[2], c2[2]


@inner
def turned_sym(r: Mat, s: Sym) -> Sym:
    """R S R^T of a symmetric S."""
    x, y, z = (r[0], r[1], r[2]), (r[3], r[4], r[5]), (r[6], r[7], r[8])
    sx, sy, sz = mul_sym(s, x), mul_sym(s, y), mul_sym(s, z)
    return dot(x, sx), dot(x, sy), dot(x, sz), dot(y, sy), dot(y, sz), dot(z, sz)


@inner
def turned_plane(r: Mat, xx: float, xy: float, yy: float) -> Sym:
    """R S R^T of a symmetric S with nothing in its third row and column."""
    ux, vx = xx * r[0] + xy * r[1], xy * r[0] + yy * r[1]
    uy, vy = xx * r[3] + xy * r[4], xy * r[3] + yy * r[4]
    uz, vz = xx * r[6] + xy * r[7], xy * r[6] + yy * r[7]
    return (
        r[0] * ux + r[1] * vx,
        r[0] * uy + r[1] * vy,
        r[0] * uz + r[1] * vz,
        r[3] * uy + r[4] * vy,
        r[3] * uz + r[4] * vz,
        r[6] * uz + r[7] * vz,
    )


@inner
def turned_rows(r: Mat, x: Vec, y: Vec) -> Mat:
    """R M R^T of a matrix with rows x, y and nothing in the third."""
    p, q = mul(r, x), mul(r, y)
    return (
        r[0] * p[0] + r[1] * q[0],
        r[0] * p[1] + r[1] * q[1],
        r[0] * p[2] + r[1] * q[2],
        r[3] * p[0] + r[4] * q[0],
        r[3] * p[1] + r[4] * q[1],
        r[3] * p[2] + r[4] * q[2],
        r[6] * p[0] + r[7] * q[0],
        r[6] * p[1] + r[7] * q[1],
        r[6] * p[2] + r[7] * q[2],
    )


@inner
def factor(s: Sym) -> Sym:
    """L D L^T of a positive definite S as (1/d0, l10, l20, 1/d1, l21, 1/d2)."""
    i0 = 1.0 / s[0]
    l10, l20 = s[1] * i0, s[2] * i0
    i1 = 1.0 / (s[3] - l10 * s[1])
    e = s[4] - l10 * s[2]
    l21 = e * i1
    return i0, l10, l20, i1, l21, 1.0 / (s[5] - l20 * s[2] - l21 * e)


@inner
def solve(f: Sym, b: Vec) -> Vec:
    """S^-1 b with ``f = factor(S)``."""
    y1 = b[1] - f[1] * b[0]
    y2 = b[2] - f[2] * b[0] - f[4] * y1
    z = y2 * f[5]
    y = y1 * f[3] - f[4] * z
    return b[0] * f[0] - f[1] * y - f[2] * z, y, z
