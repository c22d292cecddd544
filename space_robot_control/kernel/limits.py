"""Is a command within the limits of the base actuators."""

from __future__ import annotations

from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector


@kernel
def fits(share: Vector, torque: Vector, force: Vector, wrench: Vector) -> bool:
    """True if a wrench (6,) is within the limits of wheels (k, 3), or of the three axes, and of thrusters (3,)."""
    for k in range(3):
        if not abs(wrench[k]) <= force[k]:
            return False
    for wheel in range(share.shape[0]):
        part = share[wheel, 0] * wrench[3] + share[wheel, 1] * wrench[4] + share[wheel, 2] * wrench[5]
        if not abs(part) <= torque[wheel]:
            return False
    return True
