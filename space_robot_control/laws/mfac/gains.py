"""The numbers of the model-free law, with units and defaults."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt, model_validator

from space_robot_control.laws.base import Law
from space_robot_control.sensing import FilterSpec
from space_robot_description.fields import DYNAMIC
from space_robot_description.spec import Strict

Share = Annotated[float, Field(gt=0.0, le=1.0)]


class EstimatorSpec(Strict):
    """Estimator (17) of the pseudo-partial derivative."""

    sigma: Annotated[float, Field(ge=0.0, le=2.0)] = Field(
        default=0.2, description="step size [-]; 0: frozen at Phi(1)"
    )
    beta: PositiveFloat = Field(default=1.0, description="[squared units of the increments, see `units`]")
    floor: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(
        default=0.1, description="share of Phi(1) below which the estimate is reset [-]"
    )


class InitialSpec(Strict):
    """Where Phi(1) comes from."""

    source: Literal["nominal", "push", "pulses"] = Field(
        default="nominal",
        description="nominal: the nominal robot; push: the response to a push towards the target, channel by channel "
        "(19)-(22); pulses: the full matrix from one pulse train per input",
    )
    seconds: PositiveFloat = Field(default=5.0, description="length of the push, or of each pulse train [s]")
    level: Share | dict[str, Share] = Field(
        default=1.0, description="share of the limit to push with, one number or by channel [-]"
    )
    trust: PositiveFloat = Field(
        default=0.5, description="largest relative deviation of a fitted gain that is used; above, the nominal one [-]"
    )
    scale: PositiveFloat = Field(default=1.0, description="factor on Phi(1), to try a wrong one [-]")


class MfacGains(Law.Gains):
    """Gains of the model-free law; see docs/laws/mfac.md for how to choose them."""

    outputs: tuple[str, ...] = Field(
        default=(), description="channels: x, y, z, roll, pitch, yaw, joint names; default: all actuated ones"
    )
    held: tuple[str, ...] = Field(default=(), description="joints taken as rigid, where the robot file has them")
    form: Literal["rate_augmented", "position"] = Field(
        default="rate_augmented", description="output z = y + lead y', or y itself"
    )
    lead: PositiveFloat | dict[str, PositiveFloat] | None = Field(
        default=None, description="c of z, or of rho = T/c [s]; one number or by channel; default 10 control periods"
    )
    rho: PositiveFloat | None = Field(
        default=None,
        description="weight of the error [-]; default 1/(4 (1 + kappa)), position form: T / lead",
        json_schema_extra=DYNAMIC,
    )
    kappa: NonNegativeFloat = Field(default=1.0, description="lambda / phi^2 [-]", json_schema_extra=DYNAMIC)
    control_weight: NonNegativeFloat = Field(
        default=0.0, description="lambda itself, added [squared units of phi, see `units`]"
    )
    units: Literal["full_scale", "printed"] = Field(
        default="full_scale",
        description="of increments, phi, lambda and beta; full_scale: the limit of each input, and what it does to the "
        "output in a period; printed: deg, mm, N m and N, as in the paper",
    )
    output_order: PositiveInt = Field(default=2, description="Ly")
    input_order: PositiveInt = Field(default=1, description="Lu")
    estimator: EstimatorSpec = Field(default_factory=EstimatorSpec, description="of the pseudo-partial derivative")
    initial: InitialSpec = Field(default_factory=InitialSpec, description="where Phi(1) comes from")
    filter: FilterSpec | None = Field(default=None, description="rates from positions, and a gate; default: none")
    adjust: bool = Field(
        default=False, description="choose lead, kappa and rho from Phi(1), the limit and the first error"
    )

    @model_validator(mode="after")
    def _orders_fit(self) -> Self:
        if self.form == "position" and self.output_order < 2:
            raise ValueError("the position form needs output_order 2 or more: its Phi is [2, -1, ...]")
        return self
