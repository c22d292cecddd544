"""The Euler-angle baseline of Giordano and Cenedese, reconstructed."""

from __future__ import annotations

from math import radians
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.laws.ntsmc.angle_branch import AngleBranch, euler_rates, wrapped
from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.terminal_sliding import TerminalSliding
from space_robot_control.tracking import TrackingErrors
from space_robot_description.robot import Robot
from space_robot_description.rotations import Three, rpy_rates
from space_robot_description.spec import Three as ThreeNumbers
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class EulerGains(SlidingGains):
    """Gains of terminal sliding mode control with Euler angles."""

    angles: Literal["unwrapped", "wrapped"] = Field(
        default="unwrapped",
        description="unwrapped: the angles count turns and may pass pitch 90 deg; wrapped: errors in [-180, 180] [deg]",
    )
    start_deg: ThreeNumbers = Field(
        default=(0.0, 0.0, 0.0), description="unwrapped: the first angles are the ones nearest to these [deg]"
    )
    smallest_cosine: PositiveFloat = Field(
        default=1e-3, description="lower bound of |cos pitch|, which bounds the rates at the singularity [-]"
    )


class NtsmcEuler(TerminalSliding):
    """The same sliding mode on roll, pitch, yaw theta (R = Rz Ry Rx) in place of the quaternion.

        e_rot = theta - theta_d,   s_rot = sign(e_rot') |e_rot'|^r / Gamma + e_rot,   w_B = N(theta) theta'
        w_B' = N theta'' + N' theta'

    The rest is ``TerminalSliding`` and ``SlidingMode``, with the same gains. theta' = N^-1 w_B is singular at pitch
    +-90 deg; ``smallest_cosine`` is the heuristic that keeps it finite. The equations on one screen: ``reference.py``
    and ``reference_euler.py``.

    Deviations from the paper:
        This is a RECONSTRUCTION of the controller the paper compares with ([8]: Jia, Shan, IEEE TIE 67(3), 2020),
        whose text is not at hand: everything but the attitude is the quaternion law's, so that a comparison shows the
        representation alone. What [8] adapts by a norm is per DoF here; Table I's k0, k1, c0 are not separate.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: Table I by default.

    Reference: [Giordano and Cenedese 2023, sec. V, App. B]; Euler rates as in ``rotations.rpy_rates``.
    """

    Gains = EulerGains
    name = "ntsmc_euler"
    gains: EulerGains

    def __init__(self, robot: Robot, control_period: float, gains: EulerGains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self._floor = self.gains.smallest_cosine
        self.reset()

    def reset(self) -> None:
        """Forget K_hat, the disturbance estimate and the branch of the angles."""
        super().reset()
        roll, pitch, yaw = (radians(angle) for angle in self.gains.start_deg)
        self._actual, self._desired = AngleBranch((roll, pitch, yaw)), AngleBranch((0.0, 0.0, 0.0))
        self._theta: tuple[Three, Three] = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)

    def rotation(self, state: RobotState, reference: Reference, errors: TrackingErrors) -> Vector:
        """Return the errors of roll, pitch, yaw, see ``TerminalSliding`` [rad]."""
        theta, theta_d = self._actual.nearest(state.q[3:7].tolist()), self._desired.nearest(reference.q[3:7].tolist())
        rates = euler_rates(theta, state.v[3:6].tolist(), self._floor)
        omega_d, alpha_d = reference.v[3:6].tolist(), reference.a[3:6].tolist()
        rates_d = euler_rates(theta_d, omega_d, self._floor)
        # alpha = N theta'' + N' theta', so theta''_d = N^-1 (alpha_d - N' theta'_d).
        _, (bx, by, bz) = rpy_rates(theta_d, rates_d, (0.0, 0.0, 0.0))
        desired = euler_rates(theta_d, (alpha_d[0] - bx, alpha_d[1] - by, alpha_d[2] - bz), self._floor)
        e = (theta[0] - theta_d[0], theta[1] - theta_d[1], theta[2] - theta_d[2])
        if self.gains.angles == "wrapped":
            e = (wrapped(e[0]), wrapped(e[1]), wrapped(e[2]))
        rate = (rates[0] - rates_d[0], rates[1] - rates_d[1], rates[2] - rates_d[2])
        self._theta = theta, rates
        return np.array((e, rate, rate, desired))

    def angular(self, state: RobotState, acceleration: Vector) -> Three:
        """Return N theta'' + N' theta'."""
        return rpy_rates(*self._theta, acceleration)[1]
