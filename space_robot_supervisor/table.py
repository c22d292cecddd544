"""The table of a supervisor: modes and monitors, checked before anything runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    NonNegativeFloat,
    NonNegativeInt,
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
Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^\w[\w.-]*$")]


class ModeSpec(Strict):
    """What runs in a mode."""

    law: str = Field(default=CONTROLLER, description="`controller`: the experiment's; or the name of a law")
    gains: dict[str, Any] = Field(default_factory=dict, description="of that law; not of `controller`")
    reference: Literal["follow", "freeze", "here"] = Field(
        default="follow",
        description="guidance's; its value at the entry, at rest; the measured configuration at the entry",
    )

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
    inhibit_after: NonNegativeInt = Field(default=0, description="control periods without it after it fired")

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # Words of Python: the fields have other names, files do not.
        return {{"for_": "for", "in_": "in"}.get(key, key): value for key, value in handler(self).items()}

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


class SupervisionTable(Strict):
    """Modes and monitors of a supervisor."""

    title: Title = ""
    start: Name = Field(default="NOMINAL", description="mode in which a run begins")
    handover: NonNegativeFloat = Field(
        default=0.0, description="how long the last command of the law before fades out when a mode brings another [s]"
    )
    modes: dict[Name, ModeSpec] = Field(min_length=1)
    monitors: tuple[MonitorSpec, ...] = Field(default=(), max_length=1_000)

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
        self._check_reachable(key)

    def modes_of(self, row: MonitorSpec) -> tuple[str, ...]:
        """In which modes a row is looked at."""
        return row.in_ or tuple(mode for mode in self.modes if mode != row.to)

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
            news = {row.to for row in self.monitors if row.to and reached & set(self.modes_of(row))} - reached
            reached |= news
        for mode in self.modes:
            if mode not in reached:
                accepted = "a monitor that leads to it, or no such mode"
                raise SpecError("is never reached", key=f"{key}.modes.{mode}", accepted=accepted)


def _overlap(first: MonitorSpec, second: MonitorSpec) -> bool:
    """Some value fulfils both conditions."""
    if first.unchanged or second.unchanged:
        return first.unchanged and second.unchanged
    both_above = first.above is not None and second.above is not None
    both_below = first.below is not None and second.below is not None
    crossed = [(first.above, second.below), (second.above, first.below)]
    return both_above or both_below or any(a is not None and b is not None and a < b for a, b in crossed)
