"""Computed torque, the baseline: feed-forward and PD in task coordinates, nominal inverse dynamics."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, PositiveFloat

from space_robot_control.laws.base import Law
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.computed_torque.kernel.answer import (
    TorqueContext,
    TorqueRule,
    answer,
    keep,
    torque_memory,
)
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.inverse_dynamics import InverseDynamics
from space_robot_control.nominal_model import NominalModel
from space_robot_control.per_dof import Axes, Joints, PerDof
from space_robot_control.sampled_stability import stability_margin
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.fields import DYNAMIC
from space_robot_description.kernel.context import context_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


class Bandwidth(PerDof):
    """Natural frequency of each error's double integrator; one number stands for all, 0 leaves a DoF uncontrolled."""

    translation: Axes = Field(default=0.5, description="base translation, one number or per body axis [rad/s]")
    rotation: Axes = Field(default=0.5, description="base rotation, one number or per body axis [rad/s]")
    joints: Joints = Field(default=0.5, description="one number, a list, or a mapping by joint name [rad/s]")


class ComputedTorque(InverseDynamics):
    """u = M0(q) a + c0(q, v) + omega x h with a = feed-forward + Kd e_v + Kp e_x, Kp = wn^2 and Kd = 2 zeta wn per DoF.

    M0 and c0 are the nominal robot's, h the momentum of its wheels (``gyroscopic``, added), e_x, e_v and the
    feed-forward those of ``TrackingErrors``. With an exact model and a short period each error obeys
    e'' + 2 zeta wn e' + wn^2 e = 0: the base position in inertial axes if its bandwidth is one number, the attitude to
    first order in the error, the joints exactly.

    Free-floating: the force on the base is exactly zero, its translation follows from the zero-force rows of the
    nominal model, and the bandwidth of translation is not used.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        gains: bandwidth, damping, allow_unstable.

    Raises:
        SpecError: the sampled loop would be unstable, see ``stability_margin``, and ``allow_unstable`` is not set.

    The equations on one screen: ``reference.py``.

    Reference: Siciliano et al., "Robotics: Modelling, Planning and Control", 2009, sec. 8.5.2; free-floating inverse
    dynamics after Umetani and Yoshida, IEEE T-RA 5(3), 1989.
    """

    class Gains(Law.Gains):
        """Gains of computed torque."""

        bandwidth: Bandwidth = Field(
            default_factory=Bandwidth, description="natural frequency wn per DoF [rad/s]", json_schema_extra=DYNAMIC
        )
        damping: PositiveFloat = Field(
            default=1.0, description="damping ratio zeta of every DoF [-]", json_schema_extra=DYNAMIC
        )
        gyroscopic: bool = Field(default=True, description="include omega x h of the wheels' momentum in the command")
        allow_unstable: bool = Field(default=False, description="accept gains outside the sampled loop's stable region")

    name = "computed_torque"
    gain_ranges: ClassVar[GainRanges] = {
        "bandwidth": GainRange(0.05, 2.0),
        "damping": GainRange(0.4, 2.0, "linear"),
    }
    telemetry_fields = ERROR_FIELDS | {"acceleration_command": "a [m/s2, rad/s2]"}
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)
        self._memory, self._row = torque_memory(robot.n, len(robot.mimics)), _layout(robot.n)
        self._answer, self._acceleration = Answering(answer, robot.n, self._row), self._memory.acceleration
        self.retune(self.gains)

    def retune(self, gains: Gains) -> None:
        """Go on with another bandwidth or damping."""
        wn = gains.bandwidth.values(self.robot, "controller.gains.bandwidth")
        if not gains.allow_unstable:
            _check_stability(wn, gains.damping, self.control_period, self.robot)
        floating, gyroscopic = int(self.robot.base_mode == "free_floating"), int(gains.gyroscopic)
        rule = TorqueRule(wn * wn, 2.0 * gains.damping * wn, self.model.mass, floating, gyroscopic)
        context = context_of(TorqueContext(rule, self._memory, self.model.arrays), keep)
        self._form = CompiledLaw(answer, context, self._row)


def _layout(n: int) -> Layout:
    errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
    return Layout.of({**errors, "acceleration_command": 6 + n})


def _check_stability(wn: Vector, damping: float, control_period: float, robot: Robot) -> None:
    names = ["translation"] * 3 + ["rotation"] * 3 + [f"joints ({name})" for name in robot.joint_names]
    used = range(3 if robot.base_mode == "free_floating" else 0, wn.size)
    worst = max(used, key=lambda i: float(wn[i]))
    margin = stability_margin(control_period, float(wn[worst]), damping)
    if margin <= 1.0:
        raise SpecError(
            f"unstable when sampled every {control_period:g} s with damping {damping:g}",
            key=f"controller.gains.bandwidth.{names[worst]}",
            value=float(wn[worst]),
            accepted=f"below {margin * wn[worst]:.6g} rad/s (or allow_unstable: true)",
        )
