"""Reaction null space: the arm moves in the directions that do not disturb its base, the base keeps its attitude."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, PositiveFloat

from space_robot_control.laws.base import Law
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.inverse_dynamics import InverseDynamics
from space_robot_control.laws.reaction_null_space.kernel.answer import (
    NullSpaceContext,
    NullSpaceRule,
    answer,
    keep,
    null_space_memory,
)
from space_robot_control.nominal_model import NominalModel
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.fields import DYNAMIC
from space_robot_description.kernel.context import context_of
from space_robot_description.robot import Robot


class ReactionNullSpace(InverseDynamics):
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
        base = 3 if robot.base_mode == "free_floating" else 6
        self.model, self._row = NominalModel(robot), _layout(robot.n, base)
        self._memory = null_space_memory(robot.n, base, len(robot.mimics))
        self._answer, self._acceleration = Answering(answer, robot.n, self._row), self._memory.acceleration
        self.retune(self.gains)

    def retune(self, gains: Gains) -> None:
        """Go on with other gains."""
        T, floating = self.control_period, int(self.robot.base_mode == "free_floating")
        decay, bandwidth = gains.rate / (1.0 + gains.rate * T), gains.bandwidth / (1.0 + gains.bandwidth * T)
        numbers = T, gains.stiffness, decay, bandwidth, gains.weight, self.model.mass
        rule = NullSpaceRule(*numbers, floating, int(gains.gyroscopic))
        context = context_of(NullSpaceContext(rule, self._memory, self.model.arrays), keep)
        self._form = CompiledLaw(answer, context, self._row)


def _layout(n: int, base: int) -> Layout:
    errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
    return Layout.of({**errors, "rate_command": n, "reaction": base})
