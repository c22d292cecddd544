"""The numbers of non-singular terminal sliding mode control, with Table I of Giordano and Cenedese as defaults."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt, model_validator

from space_robot_control.laws.base import Law
from space_robot_control.per_dof import OneForAll
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict, expand
from space_robot_msgs_py.interfaces import Vector

Axes = PositiveFloat | Annotated[tuple[PositiveFloat, ...], Field(min_length=3, max_length=3)]
Joints = PositiveFloat | tuple[PositiveFloat, ...] | dict[str, PositiveFloat]
Share = Annotated[float, Field(ge=0.0, le=1.0)]

# Table I prints K2 for eight joints: shoulder, elbow, wrist. A shorter arm has less of a wrist, a longer one more.
TABLE_I_JOINTS = (0.1, 0.1, 0.2, 0.2, 0.6)


class PerDof(OneForAll):
    """One positive gain per degree of freedom; one number stands for all."""

    translation: Axes = Field(default=0.1, description="base translation, one number or per inertial axis")
    rotation: Axes = Field(default=0.1, description="base rotation, one number or per axis")
    joints: Joints | None = Field(
        default=None, description="one number, a list, or a mapping by joint name; default: Table I"
    )

    def expanded(self, robot: Robot, key: str, joints: Sequence[float]) -> Vector:
        """Return the (6+n,) gains; ``joints`` (n,) stands for joints that are not named.

        Raises:
            SpecError: wrong count or unknown joint; the message starts with ``key``.
        """
        out = np.empty(6 + robot.n)
        out[:3], out[3:6] = self.translation, self.rotation
        out[6:] = expand({} if self.joints is None else self.joints, robot.joint_names, f"{key}.joints", joints)
        return out


class Exponents(Strict):
    """The exponents of Table I; the sliding variable uses q/p."""

    p: PositiveInt = Field(default=9, description="with q: exponent q/p of the rate, 1 < q/p < 2 [-]")
    q: PositiveInt = Field(default=11, description="see p [-]")
    p1: PositiveInt = Field(default=5, description="with q1: exponent 2 p1/q1 of |Delta s|, 1 < q1/p1 < 2 [-]")
    q1: PositiveInt = Field(default=9, description="see p1 [-]")
    p2: PositiveInt = Field(default=7, description="with q2: exponent p2/q2 of Delta s, p2 < q2 [-]")
    q2: PositiveInt = Field(default=9, description="see p2 [-]")

    @model_validator(mode="after")
    def _in_range(self) -> Self:
        if not (self.p < self.q < 2 * self.p and self.p1 < self.q1 < 2 * self.p1 and self.p2 < self.q2):
            raise ValueError("1 < q/p < 2, 1 < q1/p1 < 2 and p2 < q2")
        return self

    @property
    def rate(self) -> float:
        """R = q/p [-]."""
        return self.q / self.p

    @property
    def reach(self) -> float:
        """p2/q2 [-]."""
        return self.p2 / self.q2


class Adaptation(Strict):
    """How the bound of the disturbance is estimated, (29), and what keeps the estimate from growing for ever."""

    initial: NonNegativeFloat = Field(default=1e-4, description="K_hat at the start, every DoF [m/s2, rad/s2]")
    rate: NonNegativeFloat = Field(default=1e-3, description="phi of (29) [s/m, s/rad]")
    leak: NonNegativeFloat = Field(default=0.0, description="decay rate of K_hat; 0: the paper's [1/s]")
    cap: PositiveFloat | None = Field(default=None, description="largest K_hat; none: the paper's [m/s2, rad/s2]")
    freeze_on_saturation: bool = Field(
        default=False, description="K_hat stays constant while the command is beyond the actuators"
    )

    @model_validator(mode="after")
    def _starts_below_the_cap(self) -> Self:
        if self.cap is not None and self.initial > self.cap:
            raise ValueError("initial must not be above cap")
        return self


class SlidingGains(Law.Gains):
    """Gains of terminal sliding mode control; [.] stands for the unit of the DoF, m or rad."""

    gamma: PerDof = Field(
        default_factory=PerDof,
        description="Gamma of (10) and (14), per DoF [s^-r, per [.]^(1-r)]",
        json_schema_extra=DYNAMIC,
    )
    k1: NonNegativeFloat = Field(
        default=1e-2, description="K_1 of (28c), for all DoFs [1/s2]", json_schema_extra=DYNAMIC
    )
    k2: PerDof = Field(default_factory=PerDof, description="K_2 of (28c), per DoF [1/s2]", json_schema_extra=DYNAMIC)
    boundary_layer: PositiveFloat = Field(
        default=1e-3, description="Phi, half width of the boundary layer [m, rad]", json_schema_extra=DYNAMIC
    )
    exponents: Exponents = Field(default_factory=Exponents, description="p, q, p1, q1, p2, q2 [-]")
    adaptation: Adaptation = Field(default_factory=Adaptation, description="of K_hat [m/s2, rad/s2]")
    clamp: bool = Field(
        default=False, description="bound u_2 and u_3 so that one held command does not overshoot s = 0"
    )
    saturation: Literal["per_axis", "direction_preserving"] = Field(
        default="per_axis",
        description="how a command is brought within the nominal actuators: each channel clipped, or u - C0 scaled [-]",
    )
    gyroscopic: bool = Field(default=True, description="include omega x h of the wheels' momentum in the command")
    disturbance_observer: Share = Field(
        default=0.0, description="share of the newest acceleration residual in the estimate d, per period; 0: off [-]"
    )

    def gamma_of(self, robot: Robot) -> Vector:
        """Return Gamma (6+n,)."""
        return self.gamma.expanded(robot, "controller.gains.gamma", [0.1] * robot.n)

    def k2_of(self, robot: Robot) -> Vector:
        """Return K_2 (6+n,), Table I cut or continued to this arm."""
        joints = [TABLE_I_JOINTS[min(i, len(TABLE_I_JOINTS) - 1)] for i in range(robot.n)]
        return self.k2.expanded(robot, "controller.gains.k2", joints)
