"""The quintic rest-to-rest profile and the frame change that every reference shares."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from space_robot_description.rotations import cross, rotate_inverse
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector


def quintic(tau: float) -> tuple[float, float, float]:
    """Return s = 10 tau^3 - 15 tau^4 + 6 tau^5 and its first two derivatives: C2 from 0 to 1, at rest at both ends.

    Args:
        tau: normalised time in [0, 1]; outside, the nearest end.
    """
    if tau <= 0.0:
        return 0.0, 0.0, 0.0
    if tau >= 1.0:
        return 1.0, 0.0, 0.0
    rest = 1.0 - tau
    return (
        tau * tau * tau * (10.0 + tau * (6.0 * tau - 15.0)),
        30.0 * tau * tau * rest * rest,
        60.0 * tau * rest * (rest - tau),
    )


def in_body(stamp: int, q: Sequence[float], v: Sequence[float], a: Sequence[float]) -> Reference:
    """Return a Reference from a motion whose linear velocity and acceleration are still in the inertial frame.

    With p' = R v and p'' = R (v' + w x v): v = R^T p' and v' = R^T p'' - w x v.

    Args:
        stamp: [ns].
        q: (7+n,) configuration [m, -, rad].
        v: (6+n,) [p' inertial, w desired body, joint rates] [m/s, rad/s].
        a: (6+n,) [p'' inertial, w' desired body, joint accelerations] [m/s2, rad/s2].
    """
    body_v, body_a = turned(q, v, a)
    # Reference makes its own arrays of whatever it gets; making them here would make them twice.
    return Reference(stamp, cast(Vector, q), cast(Vector, body_v), cast(Vector, body_a))


def turned(q: Sequence[float], v: Sequence[float], a: Sequence[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return v and a (6+n,) of ``in_body``, all in the desired body frame; arguments see there."""
    attitude = q[3:7]
    linear = rotate_inverse(attitude, v[:3])
    x, y, z = rotate_inverse(attitude, a[:3])
    cx, cy, cz = cross(v[3:6], linear)
    return (*linear, *v[3:]), (x - cx, y - cy, z - cz, *a[3:])


def nanoseconds(seconds: float, key: str) -> int:
    """Return the nearest whole number of nanoseconds.

    Raises:
        SpecError: a time above zero is shorter than a nanosecond.
    """
    stamp = round(seconds * NANOSECONDS)
    if seconds > 0.0 and stamp == 0:
        raise SpecError("too short", key=key, value=seconds, accepted="a nanosecond or more [s]")
    return stamp
