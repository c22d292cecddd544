"""The table of a supervisor: modes and monitors, checked before anything runs."""

from __future__ import annotations

from collections.abc import Iterator
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

from space_robot_description.spec import Strict, Title
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError

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
LATER = ("schedule", "sequences", "housekeeping")


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

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        said = as_typed(handler(self))
        return said if self.from_ else {key: value for key, value in said.items() if key != "from"}

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

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        said = as_typed(handler(self))
        return said if self.start else {key: value for key, value in said.items() if key != "start"}

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


class SupervisionTable(Strict):
    """Modes and monitors of a supervisor."""

    title: Title = ""
    start: Name = Field(default="NOMINAL", description="mode in which a run begins")
    handover: NonNegativeFloat = Field(
        default=0.0, description="how long the last command of the law before fades out when a mode brings another [s]"
    )
    modes: dict[Name, ModeSpec] = Field(min_length=1)
    monitors: tuple[MonitorSpec, ...] = Field(default=(), max_length=1_000)
    schedule: tuple[ScheduleStep, ...] = Field(
        default=(), max_length=1_000, description="what is done when, in the order of time"
    )
    sequences: dict[Name, tuple[SequenceStep, ...]] = Field(
        default_factory=dict, description="steps that a monitor or the schedule may start, in the order of time"
    )
    housekeeping: HousekeepingSpec | None = Field(default=None, description="null: none")

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: value for key, value in handler(self).items() if key not in LATER or value}

    def check(self, key: str) -> None:
        """Refuse what contradicts itself.

        Args:
            key: of the table, for errors.

        Raises:
            SpecError: a mode that is not there or is never reached, a name twice, transitions that contradict.
        """
        self._check_mode(self.start, f"{key}.start")
        names = [row.name for row in self.monitors]
        for index, row in enumerate(self.monitors):
            place = f"{key}.monitors.{index}"
            if row.name in RESERVED:
                raise SpecError("is the name of other events", key=f"{place}.name", value=row.name)
            if row.name in names[:index]:
                raise SpecError("there is one of that name", key=f"{place}.name", value=row.name)
            for mode in row.in_:
                self._check_mode(mode, f"{place}.in")
            if row.to is not None:
                self._check_mode(row.to, f"{place}.to")
                if row.to in row.in_:
                    accepted = "modes from which it leads somewhere else"
                    raise SpecError(
                        "leads to a mode it is looked at in", key=f"{place}.in", value=row.to, accepted=accepted
                    )
        for first, second in self._pairs():
            self._check_pair(first, second, key)
        self._check_steps(key)
        self._check_reachable(key)

    def modes_of(self, row: MonitorSpec) -> tuple[str, ...]:
        """In which modes a row is looked at."""
        return row.in_ or tuple(mode for mode in self.modes if mode != row.to)

    def _check_steps(self, key: str) -> None:
        for name, mode in self.modes.items():
            for one in mode.from_:
                self._check_mode(one, f"{key}.modes.{name}.from")
        for place, name in self._started():
            if name not in self.sequences:
                accepted = nearest(name, self.sequences) or ", ".join(self.sequences) or "a section sequences"
                raise SpecError("no such sequence", key=f"{key}.{place}", value=name, accepted=accepted)
        plans = {"schedule": [(step.at, step.do) for step in self.schedule]}
        plans |= {
            f"sequences.{name}": [(step.after, step.do) for step in steps] for name, steps in self.sequences.items()
        }
        for place, steps in plans.items():
            for index, (time, command) in enumerate(steps):
                if index and time < steps[index - 1][0]:
                    raise SpecError("before the step above", key=f"{key}.{place}.{index}", value=time)
                if command is not None:
                    self._check_mode(mode_of(command), f"{key}.{place}.{index}.do")

    def _started(self) -> Iterator[tuple[str, str]]:
        for index, row in enumerate(self.monitors):
            if row.start is not None:
                yield f"monitors.{index}.start", row.start
        for index, step in enumerate(self.schedule):
            if step.start is not None:
                yield f"schedule.{index}.start", step.start

    def _check_mode(self, mode: str, key: str) -> None:
        if mode not in self.modes:
            accepted = nearest(mode, self.modes) or ", ".join(self.modes)
            raise SpecError("no such mode", key=key, value=mode, accepted=accepted)

    def _pairs(self) -> Iterator[tuple[MonitorSpec, MonitorSpec]]:
        rows = [row for row in self.monitors if row.to is not None]
        return ((first, second) for index, first in enumerate(rows) for second in rows[index + 1 :])

    def _check_pair(self, first: MonitorSpec, second: MonitorSpec, key: str) -> None:
        """Two rows on one value must not say two things at once, nor lead to and fro."""
        if first.value != second.value or not _overlap(first, second):
            return
        together = set(self.modes_of(first)) & set(self.modes_of(second))
        if together and first.to != second.to and first.severity == second.severity:
            raise SpecError(
                f"contradicts {first.name!r}: in {min(together)} both may hold, and they lead to different modes",
                key=f"{key}.monitors",
                value=second.name,
                accepted="other bounds, modes or severities",
            )
        if second.to in self.modes_of(first) and first.to in self.modes_of(second):
            raise SpecError(
                f"leads back from where {first.name!r} leads to while its condition holds",
                key=f"{key}.monitors",
                value=second.name,
                accepted="bounds that do not overlap",
            )

    def _check_reachable(self, key: str) -> None:
        reached, news = {self.start}, {self.start}
        while news:
            news = {row.to for row in self.monitors if row.to and reached & set(self.modes_of(row))}
            # The ground may command what has the name of a command, from where the mode allows it.
            news |= {
                name
                for name, mode in self.modes.items()
                if name.lower() in COMMANDS and name.isupper() and (not mode.from_ or reached & set(mode.from_))
            }
            news -= reached
            reached |= news
        for mode in self.modes:
            if mode not in reached:
                accepted = "a monitor that leads to it, or no such mode"
                raise SpecError("is never reached", key=f"{key}.modes.{mode}", accepted=accepted)


def mode_of(command: str) -> str:
    """The mode that a command of the ground leads to."""
    return command.upper()


def as_typed(fields: dict[str, Any]) -> dict[str, Any]:
    """Words of Python: the fields have other names, files do not."""
    return {{"for_": "for", "in_": "in", "from_": "from"}.get(key, key): value for key, value in fields.items()}


def _overlap(first: MonitorSpec, second: MonitorSpec) -> bool:
    """Some value fulfils both conditions."""
    if first.unchanged or second.unchanged:
        return first.unchanged and second.unchanged
    both_above = first.above is not None and second.above is not None
    both_below = first.below is not None and second.below is not None
    crossed = [(first.above, second.below), (second.above, first.below)]
    return both_above or both_below or any(a is not None and b is not None and a < b for a, b in crossed)
