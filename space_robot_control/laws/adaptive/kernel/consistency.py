"""Is an estimate usable: finite, with positive mass, its bodies physically possible."""

from __future__ import annotations

import math

from space_robot_control.laws.adaptive.kernel.regressor import PER_BODY, total_mass
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


@kernel
def assess(parameters: Vector) -> tuple[bool, float, bool]:
    """Return whether all of (10 B,) are finite, the mass of all bodies [kg], and whether every body can exist."""
    total = 0.0
    for value in parameters:
        total += value
    possible = True
    for k in range(0, parameters.shape[0], PER_BODY):
        possible = possible and _is_possible(parameters[k : k + PER_BODY])
    return math.isfinite(total), total_mass(parameters), possible


@inner
def _is_possible(body: Vector) -> bool:
    """True if the pseudo-inertia is positive definite: the pivots of its Cholesky factorisation, the mass first."""
    mass, x, y, z = body[0], body[1], body[2], body[3]
    if not mass > 0.0:
        return False
    half = 0.5 * (body[4] + body[6] + body[9])
    xx, yy, zz = half - body[4] - x * x / mass, half - body[6] - y * y / mass, half - body[9] - z * z / mass
    xy, xz, yz = -body[5] - x * y / mass, -body[7] - x * z / mass, -body[8] - y * z / mass
    if not xx > 0.0:
        return False
    second = yy - xy * xy / xx
    if not second > 0.0:
        return False
    across = yz - xy * xz / xx
    third: float = zz - xz * xz / xx - across * across / second
    return third > 0.0
