"""What one cycle of the adaptive law works with: the law in numbers, the period that is held, and memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.laws.adaptive.kernel.regressor import PER_BODY
from space_robot_control.laws.adaptive.kernel.tree import Places, places

MODEL, ACCELEROMETER, VELOCITY = 0, 1, 2  # where the acceleration of the base comes from


class Rule(NamedTuple):
    """The law in numbers; m = 6 + n - first.

    Attributes:
        first: first actuated degree of freedom: 3 where the base translates freely, 0 where it is pushed.
        period: control period [s].
        half: half of it with lead, 0 without [s].
        on_velocity: 1: Lambda weighs the rate of the error.
        weight: (m,) Lambda.
        damping: (m, m) K_D.
        source: MODEL, ACCELEROMETER or VELOCITY, for learning.
        noise: (m,) standard deviation of the rows [N, N m].
    """

    first: int
    period: float
    half: float
    on_velocity: int
    weight: npt.NDArray[np.float64]
    damping: npt.NDArray[np.float64]
    source: int
    noise: npt.NDArray[np.float64]


class Held(NamedTuple):
    """What a period starts with and what acts over it.

    Attributes:
        x: (6+n,) Euler coordinates.
        dx: (6+n,) their rates.
        omega: (3,) body rate [rad/s].
        wheels: (3,) momentum of the wheels in the middle of the period, body frame [N m s].
        wrench: (6,) commanded on the base, body frame [N, N m].
    """

    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    omega: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    wrench: npt.NDArray[np.float64]


class Desk(NamedTuple):
    """Memory of a cycle: what is left on it is read by the law until the next one.

    Attributes:
        places: of the bodies.
        x: (6+n,) coordinates for which is computed, with lead half a period on.
        dx: (6+n,) their rates.
        x_d: (6+n,) desired.
        dx_d: (6+n,) desired.
        ddx_d: (6+n,) desired.
        before: (7+n,) desired x'' of the cycle before, and 1 if there was one.
        dx_r: (6+n,) reference velocity.
        ddx_r: (6+n,) reference acceleration.
        still: (6+n,) zeros.
        error: (m,) desired minus actual.
        sigma: (m,) sliding variable.
        entailed: (6+n,) sigma with the translation it entails.
        rows: (6+n, P) regressor of the command.
    """

    places: Places
    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    x_d: npt.NDArray[np.float64]
    dx_d: npt.NDArray[np.float64]
    ddx_d: npt.NDArray[np.float64]
    before: npt.NDArray[np.float64]
    dx_r: npt.NDArray[np.float64]
    ddx_r: npt.NDArray[np.float64]
    still: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    sigma: npt.NDArray[np.float64]
    entailed: npt.NDArray[np.float64]
    rows: npt.NDArray[np.float64]


def desk_for(joints: int, first: int) -> Desk:
    """Memory for a robot with that many joints, whose first actuated degree of freedom is this one."""
    size = 6 + joints
    return Desk(
        places=places(joints),
        x=np.zeros(size),
        dx=np.zeros(size),
        x_d=np.zeros(size),
        dx_d=np.zeros(size),
        ddx_d=np.zeros(size),
        before=np.zeros(size + 1),
        dx_r=np.zeros(size),
        ddx_r=np.zeros(size),
        still=np.zeros(size),
        error=np.zeros(size - first),
        sigma=np.zeros(size - first),
        entailed=np.zeros(size),
        rows=np.zeros((size, PER_BODY * (1 + joints))),
    )
