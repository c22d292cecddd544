"""A number with the interval that holds it at 95 %, and what both become in a formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite
from operator import truediv

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.intervals import resampled, wilson


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number and its interval; what is counted or chosen and not estimated is its own interval.

    Arithmetic takes the corners of the intervals, as if they were independent: the result is never too narrow.

    Attributes:
        value: the number.
        low: end of the interval.
        high: end of the interval.
        of: of how many runs, if the number counts or is a share of them; else 0.
    """

    value: float
    low: float
    high: float
    of: int = 0

    @property
    def exact(self) -> bool:
        """It has no interval."""
        return self.low == self.high

    def __format__(self, spec: str) -> str:
        if self.of and not spec:
            count = self.value if self.exact else self.value * self.of
            return f"{count:.0f} of {self.of} [{', '.join(f'{100 * end:.0f}' for end in wilson(count, self.of))} %]"
        spec = spec or ".4g"
        if self.exact:
            return format(self.value, spec)
        ends = ", ".join(format(end, spec) for end in (self.low, self.high))
        return f"{format(self.value, spec)} [{ends}]"

    def apply(self, function: Callable[[float, float], float], other: Estimate) -> Estimate:
        """The result of + - * / for values and intervals.

        Raises:
            ArithmeticError: the value is that of no number.
        """
        value = function(self.value, other.value)
        if not isfinite(value):
            raise OverflowError("beyond the range of numbers")
        if self.exact and other.exact:
            return exact(value)
        try:
            corners = [function(a, b) for a in (self.low, self.high) for b in (other.low, other.high)]
        except ZeroDivisionError:
            corners = [inf]
        across = function is truediv and other.low < 0.0 < other.high
        if across or not all(map(isfinite, corners)):
            return Estimate(value, -inf, inf)
        return Estimate(value, min(value, *corners), max(value, *corners))

    def negated(self) -> Estimate:
        """The negative of it."""
        return Estimate(-self.value, -self.high, -self.low)


def exact(value: float) -> Estimate:
    """A number that is not estimated."""
    return Estimate(value, value, value)


def absolute(one: Estimate) -> Estimate:
    """The size of a number."""
    ends = abs(one.low), abs(one.high)
    low = 0.0 if one.low < 0.0 < one.high else min(ends)
    return Estimate(abs(one.value), low, max(ends))


def extreme(choose: Callable[..., float], *numbers: Estimate) -> Estimate:
    """The ``min`` or ``max`` of numbers."""
    value, low, high = (choose(getattr(one, name) for one in numbers) for name in ("value", "low", "high"))
    return Estimate(value, low, high)


def less(a: Estimate, b: Estimate) -> bool | None:
    """Whether a < b; None where the intervals overlap."""
    return True if a.high < b.low else False if a.low >= b.high else None


def equal(a: Estimate, b: Estimate) -> bool | None:
    """Whether a == b; None where the intervals overlap and one of them is more than a number."""
    if a.exact and b.exact:
        return a.value == b.value
    return None if a.low <= b.high and b.low <= a.high else False


def share_of(count: float, of: int) -> Estimate:
    """A share of runs with Wilson's interval."""
    return Estimate(count / of, *wilson(count, of), of=of)


def bootstrap(values: Vector, reduction: Callable[..., Vector]) -> Estimate:
    """A mean or median with the interval of its resamples; one that is not finite has none.

    Args:
        values: (N,), one per run.
        reduction: over an axis.
    """
    value = float(reduction(values, axis=0))
    return Estimate(value, *resampled(values, reduction)) if isfinite(value) else exact(value)
