"""Three-vectors and quaternions as Python floats: on so few numbers several times faster than arrays."""

from __future__ import annotations

from collections.abc import Sequence

Triple = tuple[float, float, float]


def cross(a: Sequence[float], b: Sequence[float]) -> Triple:
    """A x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def turn(quaternion: Sequence[float], a: Sequence[float]) -> Triple:
    """A body vector in the inertial frame, by the rotation matrix of the quaternion."""
    x, y, z, w = quaternion
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a[0] + 2.0 * (x * y - z * w) * a[1] + 2.0 * (x * z + y * w) * a[2],
        2.0 * (x * y + z * w) * a[0] + (1.0 - 2.0 * (x * x + z * z)) * a[1] + 2.0 * (y * z - x * w) * a[2],
        2.0 * (x * z - y * w) * a[0] + 2.0 * (y * z + x * w) * a[1] + (1.0 - 2.0 * (x * x + y * y)) * a[2],
    )


def quaternion_rate(quaternion: Sequence[float], omega: Sequence[float]) -> tuple[float, float, float, float]:
    """dq/dt = 1/2 q omega of a quaternion (x, y, z, w) under a body rate."""
    x, y, z, w = quaternion
    a, b, c = omega
    return (
        0.5 * (w * a + y * c - z * b),
        0.5 * (w * b + z * a - x * c),
        0.5 * (w * c + x * b - y * a),
        -0.5 * (x * a + y * b + z * c),
    )


def turn_back(quaternion: Sequence[float], a: Sequence[float]) -> Triple:
    """An inertial vector in the body frame."""
    x, y, z, w = quaternion
    return turn((-x, -y, -z, w), a)
