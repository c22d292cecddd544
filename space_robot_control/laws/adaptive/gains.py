"""The numbers of the adaptive law, typed and with units."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import (
    ConfigDict,
    Field,
    NonNegativeFloat,
    PositiveFloat,
    PositiveInt,
    field_validator,
    model_validator,
)

from space_robot_control.per_dof import Axes, Joints, PerDof
from space_robot_description.fields import DYNAMIC
from space_robot_description.spec import Strict


class Lambda(PerDof):
    """Lambda of (32); one number stands for all."""

    translation: Axes = Field(default=1.0, description="base translation, free-flying robots")
    rotation: Axes = Field(default=1.0, description="base rotation: one number, or of yaw, pitch, roll")
    joints: Joints = Field(default=1.0, description="one number, a list, or a mapping by joint name")


class Reset(Strict):
    """When the covariance is reset: the only way this RLS forgets."""

    threshold: PositiveFloat = Field(
        default=25.0,
        description="squared innovation over its variance, mean of the rows, above which it is improbable [-]",
    )
    samples: PositiveInt = Field(default=2, description="improbable innovations in a row that reset [-]")


class Rls(Strict):
    """Recursive least squares, (39)-(41)."""

    torque_noise: PositiveFloat = Field(
        default=1e-3, description="standard deviation of a torque row: noise, and the error of differenced rates [N m]"
    )
    force_noise: PositiveFloat = Field(default=1e-3, description="the same of a force row, free-flying robots [N]")
    prior_spread: PositiveFloat = Field(default=0.3, description="standard deviation of a parameter over its value [-]")
    prior_floor: PositiveFloat = Field(default=1e-3, description="added, for parameters near 0 [kg, kg m, kg m2]")
    translation: Literal["model", "accelerometer", "velocity"] = Field(
        default="model",
        description="acceleration of a free-floating base: from the estimate's zero-force rows, the accelerometer, or "
        "differenced velocities (a free-flying base: always these)",
    )
    wheel_torque: Literal["measured", "commanded"] = Field(
        default="measured",
        description="torque of the wheels where they are measured: from their readings, whose noise times sqrt 2 over "
        "the control period belongs in torque_noise, or as commanded",
    )
    bandwidth: PositiveFloat = Field(
        default=0.3, description="of update rls_filtered: of the filter of both sides [rad/s]"
    )
    reset: Reset | None = Field(default_factory=Reset, description="null: never")


class Tracking(Strict):
    """The update by Lyapunov's method, (44), and its share in ``composite``."""

    gain: NonNegativeFloat = Field(
        default=1000.0, description="gamma: Gamma = gamma diag((|pi| + floor)^2), in composite gamma times covariance"
    )
    floor: PositiveFloat = Field(default=1e-3, description="for parameters near 0 [kg, kg m, kg m2]")


class AdaptiveGains(Strict):
    """Gains of the adaptive law."""

    model_config = ConfigDict(validate_by_name=False, validate_by_alias=True)

    update: Literal["none", "rls", "rls_filtered", "lyapunov", "composite"] = Field(
        default="rls", description="how the inertial parameters are corrected"
    )
    lambda_: Lambda = Field(
        default_factory=Lambda,
        alias="lambda",
        description="weight Lambda [1/s, velocity: s]",
        json_schema_extra=DYNAMIC,
    )
    lambda_on: Literal["position", "velocity"] = Field(
        default="position", description="sigma = e' + Lambda e as printed in (33), or sigma = Lambda e' + e"
    )
    kappa: PositiveFloat = Field(
        default=1.0,
        description="K_D = kappa M(pi_0, Theta_0) [1/s, lambda_on velocity: 1/s2]",
        json_schema_extra=DYNAMIC,
    )
    damping_inertia: tuple[tuple[float, ...], ...] | None = Field(
        default=None,
        description="K_D = kappa times this symmetric positive definite matrix instead of M(pi_0, Theta_0): rows of "
        "yaw, pitch, roll, joints, after x, y, z of a base that is actuated [kg m2, kg]",
    )
    lead: bool = Field(
        default=False, description="reference and state half a period ahead, against the delay of held commands"
    )
    gyroscopic: bool = Field(default=True, description="include omega x h of the wheels' momentum in command and RLS")
    rls: Rls = Field(default_factory=Rls, description="of update rls, rls_filtered and composite")
    tracking: Tracking = Field(default_factory=Tracking, description="of update lyapunov and composite")
    consistency: Literal["none", "project", "natural"] = Field(
        default="none",
        description="physically possible bodies: not enforced, the nearest ones after each update, or steps of "
        "update lyapunov along the natural gradient",
    )
    pitch_limit_deg: float = Field(
        default=80.0, gt=0.0, lt=90.0, description="largest |pitch|; beyond, Euler angles are refused [deg]"
    )

    @field_validator("damping_inertia")
    @classmethod
    def _positive_definite(cls, rows: tuple[tuple[float, ...], ...] | None) -> tuple[tuple[float, ...], ...] | None:
        if rows is not None:
            if any(len(row) != len(rows) for row in rows):
                raise ValueError("not square")
            matrix = np.array(rows)
            if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0.0) or np.linalg.eigvalsh(matrix)[0] <= 0.0:
                raise ValueError("not symmetric and positive definite")
        return rows

    @model_validator(mode="after")
    def _proven(self) -> Self:
        if self.lambda_on == "velocity" and self.update in ("lyapunov", "composite"):
            raise ValueError(f"update {self.update} needs lambda_on: position; its proof is for sigma = e' + Lambda e")
        if self.consistency == "natural" and self.update != "lyapunov":
            raise ValueError("consistency natural is for update lyapunov")
        return self
