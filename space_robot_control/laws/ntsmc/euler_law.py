"""The Euler-angle baseline of Giordano and Cenedese, reconstructed."""

from __future__ import annotations

from math import radians
from typing import Literal

from pydantic import Field, PositiveFloat

from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel.answer import UNWRAPPED, WRAPPED
from space_robot_control.laws.ntsmc.terminal_sliding import TerminalSliding
from space_robot_description.spec import Three as ThreeNumbers


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

    def attitude(self) -> int:
        """Roll, pitch, yaw that count turns, or not."""
        return int(WRAPPED if self.gains.angles == "wrapped" else UNWRAPPED)

    def smallest_cosine(self) -> float:
        """Lower bound of |cos pitch| [-]."""
        return self.gains.smallest_cosine

    @property
    def start(self) -> tuple[float, float, float]:
        """The angles that the first ones are nearest to [rad]."""
        roll, pitch, yaw = (radians(angle) for angle in self.gains.start_deg)
        return roll, pitch, yaw
