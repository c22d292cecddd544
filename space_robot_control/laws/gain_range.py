"""Between which values a gain may be searched: what a law declares beside its gains, for ``space-robot tune``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Literal

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.kernel.elementary import exp, log


@dataclass(frozen=True, slots=True)
class GainRange:
    """A range of one number, in the unit of the gain.

    Attributes:
        low: smallest value that is tried.
        high: largest.
        scale: ``log``: equal ratios count alike, as is right for bandwidths and rates; ``linear``: equal differences.

    Raises:
        SpecError: the range is empty, not finite, or ``log`` and not positive.
    """

    low: float
    high: float
    scale: Literal["log", "linear"] = "log"

    def __post_init__(self) -> None:
        if not (isfinite(self.low) and isfinite(self.high) and self.low < self.high):
            raise SpecError("is empty", key="range", value=(self.low, self.high), accepted="low < high, both finite")
        if self.scale == "log" and self.low <= 0.0:
            raise SpecError("has no logarithm", key="range.low", value=self.low, accepted="> 0, or scale: linear")

    def at(self, share: float) -> float:
        """The value at a share of the range: 0 is low, 1 is high."""
        if share <= 0.0 or share >= 1.0:
            return self.low if share <= 0.0 else self.high
        if self.scale == "linear":
            return self.low + share * (self.high - self.low)
        return exp(log(self.low) + share * (log(self.high) - log(self.low)))

    def share(self, value: float) -> float:
        """Where in the range a value lies, 0 to 1; the nearer end of what lies outside."""
        value = min(max(value, self.low), self.high)
        if self.scale == "linear":
            return (value - self.low) / (self.high - self.low)
        return (log(value) - log(self.low)) / (log(self.high) - log(self.low))


# By dotted name of the gain.
GainRanges = Mapping[str, GainRange]
