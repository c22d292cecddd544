"""Elementary functions of many numbers at once."""

from __future__ import annotations

from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2, sincos


@kernel
def sincos_rows(angles: Vector, sines: Vector, cosines: Vector) -> None:
    """Write sine and cosine of angles [rad], all (m,)."""
    for i in range(angles.shape[0]):
        sines[i], cosines[i] = sincos(angles[i])


@kernel
def atan2_rows(y: Vector, x: Vector, angles: Vector) -> None:
    """Write the angles of the points (x, y) [rad], all (m,)."""
    for i in range(angles.shape[0]):
        angles[i] = atan2(y[i], x[i])
