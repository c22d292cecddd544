"""Limits of the nominal actuators: the text of ``CommandLimits`` for kernels, without the order of BLAS in its sums."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import inner
from space_robot_msgs_py.interfaces import Vector


class Actuators(NamedTuple):
    """What the nominal actuators can do.

    Attributes:
        limit: (6+n,) largest magnitude per channel; infinite where wheels act.
        axes: (3, k) unit axes of the wheels, body frame; none without wheels.
        share: (k, 3) share of every wheel in a torque.
        torque: of a wheel [N m].
    """

    limit: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]
    share: npt.NDArray[np.float64]
    torque: float


@inner
def wheel_part(share: Vector, wheel: int, u: Vector) -> float:
    """Share of a wheel in the torque of a command (6+n,) [N m]."""
    part: float = share[wheel, 0] * u[3] + share[wheel, 1] * u[4] + share[wheel, 2] * u[5]
    return part


@inner
def within(able: Actuators, u: Vector) -> bool:
    """True if no channel and no wheel is beyond its limit."""
    fits = True
    for i in range(u.shape[0]):
        fits = fits and abs(u[i]) <= able.limit[i]
    for wheel in range(able.share.shape[0]):
        fits = fits and abs(wheel_part(able.share, wheel, u)) <= able.torque
    return fits


@inner
def clip(able: Actuators, u: Vector) -> None:
    """Clip every channel, and every wheel, of a command (6+n,) on its own."""
    for i in range(u.shape[0]):
        u[i] = max(-able.limit[i], min(able.limit[i], u[i]))
    wheels = able.share.shape[0]
    if wheels:
        x, y, z = 0.0, 0.0, 0.0
        for wheel in range(wheels):
            part = max(-able.torque, min(able.torque, wheel_part(able.share, wheel, u)))
            x += able.axes[0, wheel] * part
            y += able.axes[1, wheel] * part
            z += able.axes[2, wheel] * part
        u[3], u[4], u[5] = x, y, z
        largest = 0.0
        for wheel in range(wheels):
            largest = max(largest, abs(wheel_part(able.share, wheel, u)))
        # More than three wheels share the clipped torque again, and one may again be beyond its limit.
        if largest > able.torque:
            for k in range(3, 6):
                u[k] *= able.torque / largest


@inner
def scale_down(able: Actuators, bias: Vector, u: Vector) -> None:
    """Replace u by bias + alpha (u - bias), both (6+n,), with the largest alpha in [0, 1] that fits; then clip."""
    alpha = 1.0
    for i in range(u.shape[0]):
        alpha = min(alpha, _alpha(u[i], bias[i], able.limit[i]))
    for wheel in range(able.share.shape[0]):
        wanted, start = wheel_part(able.share, wheel, u), wheel_part(able.share, wheel, bias)
        alpha = min(alpha, _alpha(wanted, start, able.torque))
    alpha = max(0.0, alpha)
    for i in range(u.shape[0]):
        u[i] = bias[i] + alpha * (u[i] - bias[i])
    clip(able, u)


@inner
def common_scale(able: Actuators, u: Vector) -> float:
    """The largest number in [0, 1] by which a command (6+n,) fits every limit."""
    scale = 1.0
    for i in range(u.shape[0]):
        if abs(u[i]) > able.limit[i]:
            scale = min(scale, able.limit[i] / abs(u[i]))
    for wheel in range(able.share.shape[0]):
        size = abs(wheel_part(able.share, wheel, u))
        if size > able.torque:
            scale = min(scale, able.torque / size)
    return scale


@inner
def _alpha(wanted: float, start: float, limit: float) -> float:
    """How far from start to wanted a channel may go; one that is beyond its limit by the start alone: not at all."""
    if not abs(wanted) > limit:
        return 1.0
    step = wanted - start
    return (math.copysign(limit, wanted) - start) / step if step != 0.0 else 0.0
