"""What a manifest needs of runs: a number of each, and how many become one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from space_robot_description.spec import Strict

Takes = Literal["final", "max", "min", "mean", "rms", "max_abs", "integral", "settled"]
Reductions = Literal["min", "max", "mean", "median", "std", "sum", "count", "share"]
Texts = Annotated[tuple[str, ...], Field(min_length=1)]


@dataclass(frozen=True, slots=True)
class Quantity:
    """One number of one run: a metric, or something taken of a signal over a window [s]."""

    metric: str = ""
    signal: str = ""
    take: str = ""
    after: float = 0.0
    before: float | None = None
    below: float = 0.0

    def __str__(self) -> str:
        if self.metric:
            return self.metric
        until = "" if self.before is None else f" before {self.before:g} s"
        since = f" after {self.after:g} s" if self.after else ""
        bound = f" below {self.below:g}" if self.take == "settled" else ""
        return f"{self.take} of {self.signal}{bound}{since}{until}"


class Wanted(Strict):
    """A number of a run: what it is."""

    metric: str | None = Field(default=None, description="a metric of the run, or completed, or diverged")
    signal: str | None = Field(default=None, description="a signal, of which `take` takes a number")
    take: Takes | None = None
    below: PositiveFloat | None = Field(
        default=None, description="of settled: the size below which the signal stays, in its unit"
    )
    timing: Literal["mean", "median", "p99"] | None = Field(
        default=None, description="time of one control cycle [us], of a group of the timing table"
    )
    after: NonNegativeFloat = Field(default=0.0, description="the signal from this time on [s]")
    before: PositiveFloat | None = Field(default=None, description="the signal up to this time [s]")

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if [self.metric, self.signal, self.timing].count(None) != 2:
            raise ValueError("give metric, signal or timing")
        if (self.signal is None) != (self.take is None):
            raise ValueError("signal and take belong together")
        if (self.take == "settled") != (self.below is not None):
            raise ValueError("take: settled and below belong together")
        if self.signal is None and (self.after or self.before is not None):
            raise ValueError("after and before cut signals")
        if self.before is not None and self.before <= self.after:
            raise ValueError("before must be later than after")
        return self

    @property
    def quantity(self) -> Quantity:
        """What is taken of each run."""
        metric = f"cycle_time.{self.timing}" if self.timing else self.metric or ""
        return Quantity(metric, self.signal or "", self.take or "", self.after, self.before, self.below or 0.0)


class Number(Wanted):
    """A number over runs: what it is of each, and how many become one."""

    reduce: Reductions | None = Field(
        default=None, description="how the runs become one number; none: there is one run"
    )
    missing: Literal["refuse", "skip"] | float = Field(
        default="refuse", description="a run without the number: no result, left out and counted, or this number"
    )
    within: float | None = Field(default=None, description="of count and share: only runs whose number is at most this")

    @model_validator(mode="after")
    def _within_what_is_counted(self) -> Self:
        if self.within is not None and self.reduce not in ("count", "share"):
            raise ValueError("within is for reduce: count and share")
        return self


class OfGroups(Wanted):
    """A number of the runs of some groups."""

    of: str | Texts = Field(description="group, or groups")

    @property
    def groups(self) -> tuple[str, ...]:
        """The groups named."""
        return (self.of,) if isinstance(self.of, str) else self.of


class Partners(OfGroups):
    """What the runs of the same seed in these groups must have, each of them."""


class Measure(Number, OfGroups):
    """A number over the runs of one or more groups of the figure."""

    over: str = Field(default="", description="group: each number is divided by that of the run of the same seed there")
    where: dict[str, Any] = Field(default_factory=dict, description="only runs whose set or varied key has this value")
    only_if: Partners | None = Field(
        default=None, description="only runs whose partners of the same seed have this number: pairs, not two samples"
    )

    @property
    def all_groups(self) -> tuple[str, ...]:
        """Every group it needs runs of."""
        partners = self.only_if.groups if self.only_if is not None else ()
        return tuple(dict.fromkeys((*self.groups, *partners, *((self.over,) if self.over else ()))))
