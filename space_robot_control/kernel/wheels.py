"""Momentum of the nominal wheels, dead-reckoned from the commands; the equations are those of ``WheelMomentum``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.actuators import Actuators, common_scale, wheel_part, within
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class Wheels(NamedTuple):
    """The nominal wheels.

    Attributes:
        able: axes, shares and limits; without wheels nothing below changes.
        capacity: largest momentum of a wheel [N m s].
        preserve: 1: a command beyond a limit is scaled as a whole.
        stored: (k,) momentum of each wheel at the present stamp [N m s].
        momentum: (3,) of all of them, body frame [N m s].
        middle: (3,) the same in the middle of the period that ``apply_to_wheels`` was last called for [N m s].
    """

    able: Actuators
    capacity: float
    preserve: int
    stored: npt.NDArray[np.float64]
    momentum: npt.NDArray[np.float64]
    middle: npt.NDArray[np.float64]


@kernel
def apply_to_wheels(wheels: Wheels, u: Vector, seconds: float) -> None:
    """Integrate the command u (6+n,) that acts over a time [s]."""
    count = wheels.stored.shape[0]
    if count == 0:
        return
    able, capacity = wheels.able, wheels.capacity
    if within(able, u) and _has_room(wheels, u, seconds):
        for wheel in range(count):
            wheels.stored[wheel] += seconds * -wheel_part(able.share, wheel, u)
        # The same sum without the detour over the wheels.
        for k in range(3):
            taken = 0.5 * seconds * u[3 + k]
            wheels.middle[k] = wheels.momentum[k] - taken
            wheels.momentum[k] = wheels.middle[k] - taken
        return
    scale = common_scale(able, u) if wheels.preserve else 1.0
    for k in range(3):
        wheels.momentum[k], wheels.middle[k] = 0.0, 0.0
    for wheel in range(count):
        rate, before = _rate(able, wheel, scale, u), wheels.stored[wheel]
        half = max(-capacity, min(capacity, before + 0.5 * seconds * rate))
        after = max(-capacity, min(capacity, before + seconds * rate))
        wheels.stored[wheel] = after
        for k in range(3):
            wheels.middle[k] += half * able.axes[k, wheel]
            wheels.momentum[k] += after * able.axes[k, wheel]


@inner
def _has_room(wheels: Wheels, u: Vector, seconds: float) -> bool:
    """True if no wheel is full at the end of a command that is within all limits."""
    for wheel in range(wheels.stored.shape[0]):
        if not abs(wheels.stored[wheel] + seconds * -wheel_part(wheels.able.share, wheel, u)) <= wheels.capacity:
            return False
    return True


@inner
def _rate(able: Actuators, wheel: int, scale: float, u: Vector) -> float:
    """Momentum rate of a wheel under a scaled command, within its torque [N m]."""
    return max(-able.torque, min(able.torque, scale * -wheel_part(able.share, wheel, u)))
