"""The plant section of an experiment: one typed model per kind of plant, discriminated by ``kind``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, PositiveFloat, SerializerFunctionWrapHandler, Tag, model_serializer

from space_robot_description.dispersion import Dispersion
from space_robot_description.payload import Payload
from space_robot_description.spec import Strict
from space_robot_sim.capture import TargetSpec
from space_robot_sim.flexible.spec import FlexibilitySpec
from space_robot_sim.grasp.spec import AirbearingSpec, CapturedSpec
from space_robot_sim.spec import DisturbanceSpec, Hold, IntegratorSpec, MonitorSpec, SensorSpec


class ModelSpec(Strict):
    """How a model differs from the robot file."""

    payload: Payload | None = Field(default=None, description="rigid payload")
    dispersion: Dispersion | None = Field(default=None, description="random deviation of its parameters, seeded")


class PlantTiming(ModelSpec):
    """What every plant has: a true robot, and commands that come late or not at all."""

    delay_periods: Literal[0, 1] = Field(
        default=0, description="a command acts in the period of its state, or the next"
    )
    hold: Hold = Field(default="last", description="what acts when no usable command is there")
    monitor: MonitorSpec | None = Field(default=None, description="what is checked of commands before they act")

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run without a monitor is, to the byte, what it was before there was one.
        return {key: value for key, value in handler(self).items() if key != "monitor" or value is not None}


class Capture(TargetSpec):
    """A rigid body that the hand catches during the run, without notice to the law."""

    time: PositiveFloat = Field(description="when it is held from [s], a multiple of the control period")


class PlantSpec(PlantTiming):
    """What the real robot does: the truth. An articulated robot in free space."""

    kind: Literal["articulated"] = "articulated"
    capture: Capture | None = Field(default=None, description="a free body caught during the run")
    integrator: IntegratorSpec = Field(default_factory=IntegratorSpec)
    sensors: SensorSpec = Field(default_factory=SensorSpec)
    disturbance: DisturbanceSpec | None = Field(
        default=None, description="what pushes the base at all times beside its actuators"
    )
    flexibility: FlexibilitySpec | None = Field(
        default=None, description="what bends, twists and sloshes: appendages, fuel, gears; unknown to every law"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run without a disturbance, or rigid, is, to the byte, what it was before there was one.
        hidden = ("monitor", "disturbance", "flexibility")
        return {key: value for key, value in handler(self).items() if key not in hidden or value is not None}


class AirbearingPlant(PlantTiming, AirbearingSpec):
    """A testbed on air bearings: two bodies, a grasp that slips, cameras."""

    kind: Literal["airbearing"] = "airbearing"


class CapturedPlant(PlantTiming, CapturedSpec):
    """A robot in space that has captured debris in a grasp that slips (a combined spacecraft after capture)."""

    kind: Literal["pccs"] = "pccs"


def _kind(plant: Any) -> str:
    """``kind``, or the default where a file says none."""
    said = plant.get("kind", "articulated") if isinstance(plant, Mapping) else getattr(plant, "kind", "articulated")
    return str(said)


AnyPlant = Annotated[
    Annotated[PlantSpec, Tag("articulated")]
    | Annotated[AirbearingPlant, Tag("airbearing")]
    | Annotated[CapturedPlant, Tag("pccs")],
    Discriminator(
        _kind, custom_error_type="plant_kind", custom_error_message="kind: one of articulated, airbearing, pccs"
    ),
]
