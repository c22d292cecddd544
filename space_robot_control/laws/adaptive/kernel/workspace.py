"""Data of one cycle of the adaptive law: the gains, the start of the last period, and work memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.laws.adaptive.kernel.regressor import PER_BODY
from space_robot_control.laws.adaptive.kernel.tree import Places, places

MODEL, ACCELEROMETER, VELOCITY = 0, 1, 2  # where the acceleration of the base comes from


class Rule(NamedTuple):
    """The law's gains as numbers; m = 6 + n - first.

    Attributes:
        first: first actuated degree of freedom: 3 on a free-floating base, 0 on a free-flying one.
        period: control period [s].
        ahead: time from a state to the middle of the period in which its command acts, with lead; 0 without [s].
        on_velocity: 1: sigma = Lambda e' + e.
        lambda_: (m,) Lambda.
        k_d: (m, m) K_D.
        source: MODEL, ACCELEROMETER or VELOCITY, of the regression.
        noise: (m,) standard deviation of the rows [N, N m].
    """

    first: int
    period: float
    ahead: float
    on_velocity: int
    lambda_: npt.NDArray[np.float64]
    k_d: npt.NDArray[np.float64]
    source: int
    noise: npt.NDArray[np.float64]


class PeriodStart(NamedTuple):
    """State at the start of a control period and the command applied over it.

    Attributes:
        x: (6+n,) Euler coordinates.
        dx: (6+n,) their rates.
        omega: (3,) body rate [rad/s].
        wheels: (3,) momentum of the wheels in the middle of the period, body frame [N m s].
        wrench: (6,) applied command on the base, body frame [N, N m].
    """

    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    omega: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    wrench: npt.NDArray[np.float64]


class Workspace(NamedTuple):
    """Results of a cycle, which the law reads until the next one, and scratch memory.

    Attributes:
        places: of the bodies.
        x: (6+n,) coordinates for which is computed, with lead ``ahead`` on.
        dx: (6+n,) their rates.
        x_d: (6+n,) desired.
        dx_d: (6+n,) desired.
        ddx_d: (6+n,) desired.
        ddx_d_before: (7+n,) desired x'' of the cycle before, and 1 if there was one.
        dx_r: (6+n,) reference velocity.
        ddx_r: (6+n,) reference acceleration.
        zero: (6+n,) zeros.
        e: (m,) desired minus actual.
        sigma: (m,) sliding variable.
        sigma_full: (6+n,) sigma with eliminated translation: [sigma_p, sigma], sigma_p = -(M_pr sigma) / m_hat.
        Y: (6+n, P) regressor.
    """

    places: Places
    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    x_d: npt.NDArray[np.float64]
    dx_d: npt.NDArray[np.float64]
    ddx_d: npt.NDArray[np.float64]
    ddx_d_before: npt.NDArray[np.float64]
    dx_r: npt.NDArray[np.float64]
    ddx_r: npt.NDArray[np.float64]
    zero: npt.NDArray[np.float64]
    e: npt.NDArray[np.float64]
    sigma: npt.NDArray[np.float64]
    sigma_full: npt.NDArray[np.float64]
    Y: npt.NDArray[np.float64]


def workspace_for(joints: int, first: int, followers: int = 0) -> Workspace:
    """Memory for that many joints, behind this first actuated degree of freedom, and joints that follow others."""
    size = 6 + joints
    return Workspace(
        places=places(joints, followers),
        x=np.zeros(size),
        dx=np.zeros(size),
        x_d=np.zeros(size),
        dx_d=np.zeros(size),
        ddx_d=np.zeros(size),
        ddx_d_before=np.zeros(size + 1),
        dx_r=np.zeros(size),
        ddx_r=np.zeros(size),
        zero=np.zeros(size),
        e=np.zeros(size - first),
        sigma=np.zeros(size - first),
        sigma_full=np.zeros(size),
        Y=np.zeros((size, PER_BODY * (1 + joints + followers))),
    )
