"""Typed robot files: every key is checked, unknown keys are refused, numbers are finite."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, NonNegativeFloat, PositiveFloat

Three = Annotated[tuple[float, ...], Field(min_length=3, max_length=3)]
PerJoint = float | tuple[float, ...] | dict[str, float]


class Strict(BaseModel):
    """Base of every typed file: unknown keys, NaN and infinity are errors; values are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class JointMotors(Strict):
    """Joint motors. ``PerJoint`` values are one number for all joints, a list in joint order, or a mapping by joint name."""

    effort: PerJoint = Field(description="effort limit [N m or N]")
    lag: PerJoint = Field(default=0.0, description="first-order lag of the effort [s]; 0: immediate")
    viscous: PerJoint = Field(default=0.0, description="viscous friction [N m s/rad]")
    coulomb: PerJoint = Field(default=0.0, description="Coulomb friction [N m]")
    coulomb_velocity: PositiveFloat = Field(
        default=1e-3, description="rate at which Coulomb friction reaches tanh(1) of its value [rad/s]"
    )


class IdealTorque(Strict):
    """An external torque per body axis with a limit, no dynamics."""

    kind: Literal["ideal"] = "ideal"
    limit: Three = Field(description="torque limit per body axis [N m]")


class ReactionWheels(Strict):
    """Reaction wheels: they exchange angular momentum with the body and run out of it."""

    kind: Literal["reaction_wheels"] = "reaction_wheels"
    axes: tuple[Three, ...] = Field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        min_length=3,
        description="spin axes in the body frame (normalised on load; they must span 3-D)",
    )
    torque: PositiveFloat = Field(description="torque limit of one wheel [N m]")
    momentum: PositiveFloat = Field(description="momentum limit of one wheel [N m s]")
    initial_momentum: tuple[float, ...] | None = Field(default=None, description="per wheel [N m s]; default 0")


class Thrusters(Strict):
    """Force or torque per body axis by thrusters, proportional or pulsed."""

    kind: Literal["thrusters"] = "thrusters"
    limit: Three = Field(description="limit per body axis [N or N m]")
    pwm: bool = Field(default=False, description="full thrust for a part of the control period instead of a level")
    minimum_pulse: NonNegativeFloat = Field(default=0.0, description="shorter pulses are not fired [s], pwm only")


class Actuators(Strict):
    """What can push, and how hard."""

    saturation: Literal["per_axis", "direction_preserving"] = Field(
        default="per_axis", description="clip each channel, or scale the whole command until every channel fits"
    )
    joints: JointMotors
    base_torque: Annotated[IdealTorque | ReactionWheels | Thrusters, Field(discriminator="kind")]
    base_force: Thrusters | None = Field(default=None, description="required for free_flying, absent for free_floating")
