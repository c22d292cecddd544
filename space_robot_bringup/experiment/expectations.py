"""What an experiment expects: bounds on numbers of the whole run, and conditions over time, events and modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import (
    Discriminator,
    Field,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    SerializerFunctionWrapHandler,
    Tag,
    model_serializer,
    model_validator,
)

from space_robot_description.spec import Strict, Title
from space_robot_description.validation import nearest

# Keys of `expect` that hold one entry per mode, and per event.
MODE, EVENTS = "mode", "events"
# A time [s], or the name of an event.
Moment = NonNegativeFloat | Title


class Requirement(Strict):
    """Whatever is expected may say which requirement it verifies."""

    id: Title = Field(default="", description="of the requirement that it verifies, e.g. REQ-042")

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run that expects bounds alone is, to the byte, what it was before there was anything else.
        return {key: value for key, value in handler(self).items() if key != "id" or value}


class Expectation(Requirement):
    """What a metric should be; at least one bound."""

    value: float | None = Field(default=None, description="expected value, in the metric's unit")
    tolerance: NonNegativeFloat = Field(default=0.0, description="allowed distance from the value")
    min: float | None = None
    max: float | None = None

    @model_validator(mode="after")
    def _can_hold(self) -> Self:
        if self.value is None and self.min is None and self.max is None:
            raise ValueError("give value, min or max")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError("min must not be above max")
        return self


class Temporal(Requirement):
    """When, how long and how often a condition holds."""

    within: NonNegativeFloat | None = Field(
        default=None, description="it holds at the latest so long [s] after each `after`, or after the start"
    )
    at_most: NonNegativeInt | None = Field(default=None, description="it begins to hold so many times, or fewer")
    at_least: PositiveInt | None = Field(default=None, description="it begins to hold so many times, or more")
    at_end: Literal[True] | None = Field(default=None, description="it holds at the last tick of the run")
    for_: PositiveFloat | None = Field(
        default=None, alias="for", description="only what lasts so long [s], from its first tick to its last, counts"
    )
    after: Moment | None = Field(
        default=None, description="judged from this time [s] on, or from this event on; default: the start"
    )
    until: Moment | None = Field(
        default=None, description="judged up to this time [s], or this event, which are not part of it; default: end"
    )

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # `for` is a word of Python: the field has another name, files do not.
        found = {"for" if key == "for_" else key: value for key, value in handler(self).items()}
        return {key: value for key, value in found.items() if value not in (None, "")}

    @property
    def counts(self) -> bool:
        """It is about how often."""
        return self.at_most is not None or self.at_least is not None

    def _check_pattern(self, others: int, accepted: str) -> None:
        """One pattern, and no key that has no meaning in it."""
        if sum((self.within is not None, self.counts, self.at_end is not None)) + others != 1:
            raise ValueError(f"give exactly one of {accepted}")
        if self.at_most is not None and self.at_least is not None and self.at_least > self.at_most:
            raise ValueError("at_least must not be more than at_most")
        if self.until is not None and (self.within is not None or self.at_end is not None):
            raise ValueError("until is for never, always, at_most and at_least")
        if self.after is not None and self.at_end is not None:
            raise ValueError("after is for everything but at_end")
        ends = [moment for moment in (self.after, self.until) if isinstance(moment, float | int)]
        if len(ends) == 2 and ends[0] >= ends[1]:
            raise ValueError("after must be before until")


class OverTime(Temporal):
    """A number over time: its bound, and when, how long and how often it may be beyond."""

    never_above: float | None = Field(default=None, description="it is never more than this, in its unit")
    never_below: float | None = Field(default=None, description="it is never less than this, in its unit")
    above: float | None = Field(
        default=None, description="the condition: more than this; with within, at_most, at_least or at_end"
    )
    below: float | None = Field(default=None, description="the condition: less than this; likewise")

    @model_validator(mode="after")
    def _one_condition(self) -> Self:
        bounds = (self.never_above, self.never_below, self.above, self.below)
        if sum(bound is not None for bound in bounds) != 1:
            raise ValueError("give exactly one of never_above, never_below, above and below")
        never = self.never_above is not None or self.never_below is not None
        also = "" if never else " beside above or below"
        self._check_pattern(int(never), f"never_above, never_below, within, at_most (at_least) and at_end{also}")
        return self


class Occurrence(Temporal):
    """A mode that is entered and left, or an event that happens."""

    never: Literal[True] | None = Field(default=None, description="it never is, or never happens")
    always: Literal[True] | None = Field(default=None, description="it is all the time; for modes")

    @model_validator(mode="after")
    def _one_pattern(self) -> Self:
        others = (self.never is not None) + (self.always is not None)
        self._check_pattern(others, "never, always, within, at_most (at_least) and at_end")
        if self.always and self.for_ is not None:
            raise ValueError("for has no meaning with always")
        return self


def _kind(value: Any) -> str:
    """Which of the forms below a value is meant as; their keys say which."""
    if isinstance(value, Requirement):
        return type(value).__name__
    if isinstance(value, list | tuple):
        return "several"
    if not isinstance(value, Mapping):
        return Expectation.__name__
    if value and all(isinstance(one, Mapping | Temporal | list | tuple) for one in value.values()):
        return "each"
    own = (set(Expectation.model_fields) | {"id"}, {"for", *OverTime.model_fields} - {"id"})
    exact = [sum(key in keys for key in value if key != "id") for keys in own]
    if max(exact) > min(exact):
        return (Expectation if exact[0] > exact[1] else OverTime).__name__
    close = [sum(bool(nearest(key, keys)) for key in value) for keys in own]
    return (Expectation if close[0] >= close[1] else OverTime).__name__


Occurrences = Occurrence | tuple[Occurrence, ...]
AnyExpectation = Annotated[
    Annotated[Expectation, Tag("Expectation")]
    | Annotated[OverTime, Tag("OverTime")]
    | Annotated[tuple[OverTime, ...], Tag("several"), Field(min_length=1)]
    | Annotated[dict[str, Occurrences], Tag("each")],
    Discriminator(_kind),
]


def bounds_of(expect: Mapping[str, AnyExpectation]) -> dict[str, Expectation]:
    """Of what is expected the bounds on numbers of the whole run."""
    return {name: one for name, one in expect.items() if isinstance(one, Expectation)}
