"""Reaction null space: the arm moves in the directions that do not disturb its base, the base keeps its attitude."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.laws.base import Blocks, Law
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.nominal_model import NominalModel
from space_robot_control.tracking import ERROR_FIELDS, TrackingErrors, error_blocks, tracking_errors
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class ReactionNullSpace(Law):
    """u = M0(q) [a_b, a_J] + c0(q, v) + omega x h: joints along N (q_d' + k e), N the filter of reaction-free rates.

    With H_b, H_bm the base's own and the coupling inertia, J = -H_b^-1 H_bm is the generalised Jacobian of the base:
    the base velocity that joint rates bring about where no momentum is exchanged. N = (I + lambda^2 J^T J)^-1 makes
    |r' - r|^2 + lambda^2 |J r'|^2 least over r'; for lambda to infinity it is the projector on the reaction null space
    J r' = 0. The command of rates is s(t) = N(q) (q_d' + k e), its value one period ahead s_1, and

        a_J = (s_1 - s) / T + w' (s - q'), w' = w / (1 + w T);    a_b = feed-forward + 2 wn' e_v + wn'^2 e_x.

    wn' = wn / (1 + wn T). Where the arm has less than as many spare joints as the base has directions that it disturbs,
    most references cannot be followed without reaction: the joints come to rest where what is left of the error
    moves the base, or creep there at k / (1 + lambda^2 sigma^2), sigma a singular value of J.

    Free-floating: three rows, rotation, with the translation eliminated; the force on the base is exactly zero.
    Free-flying: six, a metre counts as a radian.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: stiffness, rate, bandwidth, weight, gyroscopic.

    The equations on one screen: ``reference.py``.

    Reference: Nenchev, Umetani, Yoshida, "Analysis of a redundant free-flying spacecraft/manipulator system", IEEE T-RA
    8(1), 1992; Nenchev, Yoshida, Vichitkulsawat, Uchiyama, "Reaction null-space control of flexible structure mounted
    manipulator systems", IEEE T-RA 15(6), 1999; Umetani and Yoshida, IEEE T-RA 5(3), 1989.

    Deviations from the paper: the projector is damped (lambda is a number), which has no rank to decide on at a
    singular posture; the base is kept by its own actuators, which have nothing to do as long as the model is right.
    """

    class Gains(Law.Gains):
        """Gains of reaction-free motion."""

        stiffness: PositiveFloat = Field(
            default=0.2, description="k, of the joint errors in the command of rates [1/s]", json_schema_extra=DYNAMIC
        )
        rate: PositiveFloat = Field(
            default=1.0, description="w, with which joint rates go to the command [1/s]", json_schema_extra=DYNAMIC
        )
        bandwidth: PositiveFloat = Field(default=0.3, description="wn of the base [rad/s]", json_schema_extra=DYNAMIC)
        weight: PositiveFloat = Field(
            default=1000.0,
            description="lambda, of base rates against joint rates: small, follow; large, no reaction [-]",
            json_schema_extra=DYNAMIC,
        )
        gyroscopic: bool = Field(default=True, description="include omega x h of the wheels' momentum in the command")

    name = "reaction_null_space"
    gain_ranges: ClassVar[GainRanges] = {
        "stiffness": GainRange(0.02, 2.0),
        "rate": GainRange(0.05, 5.0),
        "bandwidth": GainRange(0.02, 2.0),
        "weight": GainRange(0.1, 10_000.0),
    }
    telemetry_fields = ERROR_FIELDS | {
        "rate_command": "s, joint rates that are commanded [rad/s or m/s]",
        "reaction": "J s, what they would give the base [m/s (free-flying only), rad/s]",
    }
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)
        self._base = 3 if robot.base_mode == "free_floating" else 6

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the inverse dynamics of the nominal model is not finite.
        """
        T, errors = self.control_period, tracking_errors(state, reference)
        desired, e, e_rate = reference.v[6:], errors.joints, errors.joint_rates
        k = self.gains.stiffness
        jacobian = self._jacobian(state.q)
        now = self._filtered(jacobian, desired + k * e)
        ahead = np.array(state.q)
        ahead[7:] += T * state.joint_rates
        then = self._filtered(self._jacobian(ahead), desired + T * reference.a[6:] + k * (e + T * e_rate))
        decay = self.gains.rate / (1.0 + self.gains.rate * T)
        a = np.concatenate([self._base_acceleration(errors), (then - now) / T + decay * (now - state.joint_rates)])
        u, _ = self.model.actuated_inverse_dynamics(state.q, state.v, a)
        if self.gains.gyroscopic:
            self.wheels.add_torque(u, state.v[3:6])
        return u, {**error_blocks(errors), "rate_command": now, "reaction": jacobian @ now}

    def _base_acceleration(self, errors: TrackingErrors) -> Vector:
        """a_b (6,) [m/s2, rad/s2]."""
        wn = self.gains.bandwidth / (1.0 + self.gains.bandwidth * self.control_period)
        out: Vector = errors.feedforward[:6] + 2.0 * wn * errors.twist + wn**2 * errors.configuration[:6]
        return out

    def _jacobian(self, q: Vector) -> Vector:
        """J (3 or 6, n) of a configuration [1/s per rad/s]."""
        inertia, b = self.model.actuated_mass_matrix(q), self._base
        return -np.array(np.linalg.solve(inertia[:b, :b], inertia[:b, b:]))

    def _filtered(self, jacobian: Vector, rates: Vector) -> Vector:
        """N r (n,) of joint rates r: r - lambda^2 J^T (I + lambda^2 J J^T)^-1 J r."""
        weighted = self.gains.weight * jacobian
        inner = np.identity(self._base) + weighted @ weighted.T
        out: Vector = rates - weighted.T @ np.linalg.solve(inner, weighted @ rates)
        return out
