"""The rows of a supervision table: modes, monitors, steps of a plan, housekeeping."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from space_robot_description.spec import Strict

# What a mode says for the law of the experiment.
CONTROLLER = "controller"
Severity = Literal["info", "low", "medium", "high"]
SEVERITIES: tuple[Severity, ...] = ("info", "low", "medium", "high")
# Commands of the ground, and by the mode's name in capitals what they lead to.
COMMANDS = ("standby", "nominal", "hold", "safe", "stop")
GroundCommand = Literal["standby", "nominal", "hold", "safe", "stop"]
ReferencePolicy = Literal["follow", "freeze", "here"]
REFERENCES: tuple[ReferencePolicy, ...] = ("follow", "freeze", "here")
Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^\w[\w.-]*$")]


# Names of events that are no monitor's.
RESERVED = ("mode", "command", "sequence")
# Keys that older tables do not have: where they say nothing a log has nothing of them.
LATER = ("schedule", "sequences", "housekeeping", "fallback")
LATER_OF_MODES, LATER_OF_MONITORS = ("from", "forget", "brakes", "wheels_off", "unload"), ("start", "times")


class ModeSpec(Strict):
    """What runs in a mode."""

    law: str = Field(default=CONTROLLER, description="`controller`: the experiment's; or the name of a law")
    gains: dict[str, Any] = Field(default_factory=dict, description="of that law; not of `controller`")
    reference: ReferencePolicy = Field(
        default="follow",
        description="guidance's; its value at the entry, at rest; the measured configuration at the entry",
    )
    from_: tuple[Name, ...] = Field(
        default=(),
        alias="from",
        description="modes from which commands, schedule and sequences lead here; default: all",
    )
    forget: bool = Field(
        default=False, description="a law that takes over here has forgotten what it learned of the robot in the run"
    )

    brakes: bool = Field(default=False, description="the brakes of all joints are closed; robots that have some")
    wheels_off: tuple[NonNegativeInt, ...] = Field(
        default=(), description="wheels that failed, from 0: the others give their part of the torque, too"
    )
    unload: bool = Field(default=False, description="thrusters unload the wheels; robots that have some for that")

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return said(as_typed(handler(self)), LATER_OF_MODES)

    @model_validator(mode="after")
    def _gains_of_a_law(self) -> Self:
        if self.law == CONTROLLER and self.gains:
            raise ValueError("gains of `controller` stand in the experiment")
        return self


class MonitorSpec(Strict):
    """One row: a condition on one value, and what it leads to."""

    name: Name = Field(description="what its events are called")
    value: str = Field(description="what it reads")
    above: float | None = Field(default=None, description="it is more than this, in the value's unit")
    below: float | None = Field(default=None, description="it is less than this, in the value's unit")
    unchanged: bool = Field(default=False, description="it is what it was at the tick before, to the bit")
    hysteresis: NonNegativeFloat = Field(
        default=0.0, description="how far back the value must be before the condition has ended, in the value's unit"
    )
    for_: PositiveInt = Field(
        default=1, alias="for", description="control periods in a row that the condition must hold"
    )
    in_: tuple[Name, ...] = Field(default=(), alias="in", description="modes in which it is looked at; default: all")
    severity: Severity = Field(default="medium", description="of its event; of several that fire the highest decides")
    to: Name | None = Field(default=None, description="mode that it leads to; null: only the event")
    start: Name | None = Field(default=None, description="sequence that it starts; null: none")
    inhibit_after: NonNegativeInt = Field(default=0, description="control periods without it after it fired")
    times: PositiveInt | None = Field(default=None, description="how often it fires in a run at most; null: always")

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return said(as_typed(handler(self)), LATER_OF_MONITORS)

    @model_validator(mode="after")
    def _one_condition(self) -> Self:
        bounded = self.above is not None or self.below is not None
        if bounded == self.unchanged:
            raise ValueError("say above, below or both (outside of a band), or unchanged: true")
        if self.above is not None and self.below is not None and self.below > self.above:
            raise ValueError("below must not be more than above: every value would be outside")
        if self.unchanged and self.hysteresis:
            raise ValueError("hysteresis is for above and below")
        return self


class ScheduleStep(Strict):
    """What is done at a time of the run."""

    at: NonNegativeFloat = Field(description="time of the run; it acts at the first tick at or after [s]")
    do: GroundCommand | None = Field(default=None, description="command, as the ground gives it")
    start: Name | None = Field(default=None, description="sequence that is started")

    @model_validator(mode="after")
    def _one_thing(self) -> Self:
        if (self.do is None) == (self.start is None):
            raise ValueError("give do or start, one of them")
        return self


class SequenceStep(Strict):
    """What is done some time after a sequence was started."""

    after: NonNegativeFloat = Field(description="time since the start of the sequence [s]")
    do: GroundCommand = Field(description="command, as the ground gives it")


class HousekeepingSpec(Strict):
    """What is summed up for the ground, and how often."""

    period: PositiveFloat = Field(default=10.0, description="multiple of the control period [s]")
    values: tuple[str, ...] = Field(default=(), max_length=200, description="values, as monitors read them")


def as_typed(fields: dict[str, Any]) -> dict[str, Any]:
    """Words of Python: the fields have other names, files do not."""
    return {{"for_": "for", "in_": "in", "from_": "from"}.get(key, key): value for key, value in fields.items()}


def said(fields: dict[str, Any], later: Collection[str]) -> dict[str, Any]:
    """Without those of the later keys that say nothing."""
    return {key: value for key, value in fields.items() if key not in later or value}
