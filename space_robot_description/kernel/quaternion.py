"""Unit quaternions (x, y, z, w) for kernels: the text of ``space_robot_description.rotations`` under the same names.

Equal to the bit but for ``log``, whose length numba cannot take by ``hypot``; a test holds the two together.
"""

from __future__ import annotations

from math import sqrt

from space_robot_description.kernel.jit import inner
from space_robot_description.kernel.spatial import Mat, Vec
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2

Quat = tuple[float, float, float, float]


@inner
def attitude(q: Vector) -> Quat:
    """The quaternion of a configuration (7+n,), or of a state that begins with one."""
    return q[3], q[4], q[5], q[6]


@inner
def three(v: Vector, k: int) -> Vec:
    """Three numbers of an array from entry k."""
    return v[k], v[k + 1], v[k + 2]


@inner
def put(v: Vector, k: int, a: Vec) -> None:
    """Store three numbers in an array from entry k."""
    v[k], v[k + 1], v[k + 2] = a


@inner
def relative(a: Quat, b: Quat) -> Quat:
    """Quaternion of R(a)^T R(b), the short way (w >= 0, sgn(0) = +1)."""
    w = a[3] * b[3] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    sign = -1.0 if w < 0.0 else 1.0
    return (
        sign * (a[3] * b[0] - a[0] * b[3] - a[1] * b[2] + a[2] * b[1]),
        sign * (a[3] * b[1] + a[0] * b[2] - a[1] * b[3] - a[2] * b[0]),
        sign * (a[3] * b[2] - a[0] * b[1] + a[1] * b[0] - a[2] * b[3]),
        sign * w,
    )


@inner
def rotate(q: Quat, r: Vec) -> Vec:
    """R(q) r."""
    x, y, z, w = q
    tx, ty, tz = 2.0 * (y * r[2] - z * r[1]), 2.0 * (z * r[0] - x * r[2]), 2.0 * (x * r[1] - y * r[0])
    return r[0] + w * tx + y * tz - z * ty, r[1] + w * ty + z * tx - x * tz, r[2] + w * tz + x * ty - y * tx


@inner
def rotate_inverse(q: Quat, r: Vec) -> Vec:
    """R(q)^T r."""
    return rotate((-q[0], -q[1], -q[2], q[3]), r)


@inner
def matrix(q: Quat) -> Mat:
    """Rotation matrix R(q)."""
    x, y, z, w = q
    return (
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - z * w),
        2.0 * (x * z + y * w),
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
        2.0 * (x * z - y * w),
        2.0 * (y * z + x * w),
        1.0 - 2.0 * (x * x + y * y),
    )


@inner
def quaternion_rate(q: Quat, omega: Vec) -> Quat:
    """dq/dt = 1/2 q omega under a body rate."""
    x, y, z, w = q
    a, b, c = omega
    return (
        0.5 * (w * a + y * c - z * b),
        0.5 * (w * b + z * a - x * c),
        0.5 * (w * c + x * b - y * a),
        -0.5 * (x * a + y * b + z * c),
    )


@inner
def log(q: Quat) -> Vec:
    """Rotation vector of a quaternion with w >= 0."""
    length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    scale = 2.0 * atan2(length, q[3]) / length if length > 0.0 else 2.0
    return scale * q[0], scale * q[1], scale * q[2]
