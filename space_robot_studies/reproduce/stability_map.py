"""A drawing that needs no runs: where the model-free loop is stable, over its two numbers."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, PositiveFloat, model_validator

from space_robot_description.spec import Strict

Decades = tuple[PositiveFloat, PositiveFloat]


class Mark(Strict):
    """A setting on the map."""

    ratio: PositiveFloat = Field(description="phi^2 / lambda [-]")
    rho: PositiveFloat = Field(description="rho_3, weight of the error [-]")


class StabilityMap(Strict):
    """Where the model-free loop on a double integrator is stable, over phi^2 / lambda and rho_3, both logarithmic.

    Drawn are the regions of a held command without and with a period of delay, and of the difference equation.
    """

    label: str = Field(min_length=1, description="title of the map")
    lead: PositiveFloat | None = Field(
        default=None, description="control periods of rate in the output z = y + c y'; none: the output is y"
    )
    ratio: Decades = Field(default=(1e-3, 1e3), description="range of phi^2 / lambda [-]")
    rho: Decades = Field(default=(1e-3, 2.0), description="range of rho_3 [-]")
    points: Annotated[int, Field(ge=10, le=400)] = Field(default=90, description="of the grid, each way")
    marks: dict[str, Mark] = Field(default_factory=dict, description="text -> setting")

    @model_validator(mode="after")
    def _rising(self) -> Self:
        for name in ("ratio", "rho"):
            low, high = getattr(self, name)
            if low >= high:
                raise ValueError(f"{name} is [low, high], not [{low:g}, {high:g}]")
        return self
