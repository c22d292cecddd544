"""Rotations as unit quaternions (x, y, z, w), Hamilton product, body to inertial unless said otherwise.

Every function takes sequences of floats (tuples, lists, arrays) and returns a tuple of Python floats: at three or four
numbers that is several times faster than NumPy, and a control period calls these a dozen times. A tuple is no vector:
``+`` joins two of them. Wrap one in ``np.array`` before adding or scaling.

Kernels have the same text in ``kernel/quaternion.py``.

Reference: Sola, "Quaternion kinematics for the error-state Kalman filter", 2017, secs. 1-2 and 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt

import numpy as np

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2, sincos

Floats = Sequence[float] | Vector
Three = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

# What roll, pitch and yaw are in files and plots.
EULER = "Euler angles R = Rz Ry Rx"


def normalized(q: Floats, key: str = "quaternion") -> Quaternion:
    """Scale a quaternion to unit length.

    Args:
        q: (4,) of any length but zero.
        key: what to call it in an error.

    Raises:
        SpecError: the quaternion has no direction.
    """
    x, y, z, w = _floats(q)
    length = sqrt(x * x + y * y + z * z + w * w)
    if not 1e-9 < length < 1e9:
        raise SpecError("not a rotation", key=key, value=[x, y, z, w], accepted="x, y, z, w, not all zero, finite")
    return x / length, y / length, z / length, w / length


def product(a: Floats, b: Floats) -> Quaternion:
    """Return the quaternion of the rotation b followed by a, R(a) R(b) [-]."""
    ax, ay, az, aw = _floats(a)
    bx, by, bz, bw = _floats(b)
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Floats) -> Quaternion:
    """Return the inverse rotation of a unit quaternion [-]."""
    x, y, z, w = _floats(q)
    return -x, -y, -z, w


def relative(a: Floats, b: Floats) -> Quaternion:
    """Return the quaternion of R(a)^T R(b), from frame b to frame a, on the short way (w >= 0, sgn(0) = +1) [-]."""
    ax, ay, az, aw = _floats(a)
    bx, by, bz, bw = _floats(b)
    w = aw * bw + ax * bx + ay * by + az * bz
    sign = -1.0 if w < 0.0 else 1.0
    return (
        sign * (aw * bx - ax * bw - ay * bz + az * by),
        sign * (aw * by + ax * bz - ay * bw - az * bx),
        sign * (aw * bz - ax * by + ay * bx - az * bw),
        sign * w,
    )


def rotate(q: Floats, r: Floats) -> Three:
    """Return R(q) r for a unit quaternion and a vector (3,)."""
    x, y, z, w = _floats(q)
    a, b, c = _floats(r)
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx


def rotate_inverse(q: Floats, r: Floats) -> Three:
    """Return R(q)^T r for a unit quaternion and a vector (3,)."""
    x, y, z, w = _floats(q)
    a, b, c = _floats(r)
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return a - w * tx + y * tz - z * ty, b - w * ty + z * tx - x * tz, c - w * tz + x * ty - y * tx


def rotate_by_matrix(q: Floats, r: Floats) -> Three:
    """Return R(q) r by the elements of ``matrix``, to the bit what kernels get that keep the matrix."""
    x, y, z, w = _floats(q)
    a, b, c = _floats(r)
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a + 2.0 * (x * y - z * w) * b + 2.0 * (x * z + y * w) * c,
        2.0 * (x * y + z * w) * a + (1.0 - 2.0 * (x * x + z * z)) * b + 2.0 * (y * z - x * w) * c,
        2.0 * (x * z - y * w) * a + 2.0 * (y * z + x * w) * b + (1.0 - 2.0 * (x * x + y * y)) * c,
    )


def quaternion_rate(q: Floats, omega: Floats) -> Quaternion:
    """Return dq/dt = 1/2 q omega of a quaternion under a body rate (3,) [rad/s]."""
    x, y, z, w = _floats(q)
    a, b, c = _floats(omega)
    return (
        0.5 * (w * a + y * c - z * b),
        0.5 * (w * b + z * a - x * c),
        0.5 * (w * c + x * b - y * a),
        -0.5 * (x * a + y * b + z * c),
    )


def cross(a: Floats, b: Floats) -> Three:
    """Return a x b; np.cross takes ten times as long for one pair of vectors."""
    ax, ay, az = _floats(a)
    bx, by, bz = _floats(b)
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def matrix(q: Floats) -> Vector:
    """Return the (3, 3) rotation matrix of a unit quaternion."""
    x, y, z, w = _floats(q)
    return np.array(
        (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
    )


def exp(rotation_vector: Floats) -> Quaternion:
    """Return the unit quaternion of a rotation vector (3,) [rad]."""
    x, y, z = _floats(rotation_vector)
    angle = sqrt(x * x + y * y + z * z)
    sine, cosine = sincos(0.5 * angle)
    scale = sine / angle if angle > 0.0 else 0.5
    return scale * x, scale * y, scale * z, cosine


def log(q: Floats) -> Three:
    """Return the rotation vector (3,) of a quaternion, the short way, length at most pi [rad].

    atan2 of both half-angle functions keeps full accuracy near 0 and near pi, where acos and asin lose half the digits.
    """
    x, y, z, w = _floats(q)
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    length = sqrt(x * x + y * y + z * z)
    scale = 2.0 * atan2(length, w) / length if length > 0.0 else 2.0
    return scale * x, scale * y, scale * z


def from_rpy(rpy: Floats) -> Quaternion:
    """Return the quaternion of roll, pitch, yaw [rad]: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = _floats(rpy)
    (sr, cr), (sp, cp), (sy, cy) = sincos(0.5 * roll), sincos(0.5 * pitch), sincos(0.5 * yaw)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def to_rpy(q: Floats) -> Three:
    """Return roll, pitch, yaw of a unit quaternion [rad], pitch in [-pi/2, pi/2], the others in [-pi, pi].

    Sums and differences of the components factor into (cos +- sin)(pitch/2) times sine and cosine of half the sum and
    difference of roll and yaw, so the result stays a valid decomposition at pitch = +-pi/2 too.

    Reference: Bernardes and Viollet, "Quaternion to Euler angles conversion", PLoS ONE 17(11), 2022.
    """
    x, y, z, w = _floats(q)
    difference, half_sum = atan2(x - z, w + y), atan2(x + z, w - y)
    across, along = sqrt((w + y) * (w + y) + (x - z) * (x - z)), sqrt((w - y) * (w - y) + (x + z) * (x + z))
    pitch = 2.0 * atan2(across, along) - 0.5 * pi
    return _wrapped(half_sum + difference), pitch, _wrapped(half_sum - difference)


def rpy_rates(rpy: Floats, rates: Floats, accelerations: Floats) -> tuple[Three, Three]:
    """Return body angular velocity [rad/s] and acceleration [rad/s2] of a motion given in roll, pitch, yaw.

    omega = N(roll, pitch) rpy', N = [[1, 0, -sp], [0, cr, sr cp], [0, -sr, cr cp]]; alpha is its time derivative.

    Args:
        rpy: roll, pitch, yaw [rad].
        rates: their first derivatives [rad/s].
        accelerations: their second derivatives [rad/s2].
    """
    roll, pitch, _ = _floats(rpy)
    dr, dp, dy = _floats(rates)
    ddr, ddp, ddy = _floats(accelerations)
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    yaw_rate, yaw_acceleration = dy * cp, ddy * cp - dy * dp * sp
    wy, wz = dp * cr + yaw_rate * sr, yaw_rate * cr - dp * sr
    omega = (dr - dy * sp, wy, wz)
    alpha = (
        ddr - ddy * sp - dy * dp * cp,
        ddp * cr + yaw_acceleration * sr + dr * wz,
        yaw_acceleration * cr - ddp * sr - dr * wy,
    )
    return omega, alpha


def _floats(values: Floats) -> Sequence[float]:
    # Unpacking an array gives NumPy scalars, whose arithmetic is several times slower than that of floats.
    return values.tolist() if isinstance(values, np.ndarray) else values


def _wrapped(angle: float) -> float:
    if angle > pi:
        return angle - 2.0 * pi
    if angle < -pi:
        return angle + 2.0 * pi
    return angle
