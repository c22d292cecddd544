"""Seconds people write, integer nanoseconds the product runs on."""

from __future__ import annotations

from decimal import Decimal

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS

# Telemetry holds stamps as doubles, exact up to here (104 days).
LAST_STAMP = 2**53


def to_nanoseconds(seconds: float, key: str) -> int:
    """Exact conversion of a decimal number of seconds.

    Raises:
        SpecError: it is not a whole number of nanoseconds, or not positive.
    """
    exact = Decimal(repr(float(seconds))) * NANOSECONDS
    if exact != exact.to_integral_value() or exact <= 0:
        raise SpecError("not a whole number of nanoseconds", key=key, value=seconds, accepted="e.g. 0.25")
    return int(exact)


def steps_of(duration: float, control_period: float, key: str = "duration") -> int:
    """Number of control periods in a duration; ``key`` names it in an error.

    Raises:
        SpecError: the duration is not a multiple of the control period, or beyond the last stamp.
    """
    total, period = to_nanoseconds(duration, key), to_nanoseconds(control_period, "control_period")
    if total > LAST_STAMP:
        longest = f"at most {LAST_STAMP / NANOSECONDS:.0f} s, the last stamp a log can hold"
        raise SpecError("too long", key=key, value=duration, accepted=longest)
    steps, rest = divmod(total, period)
    if rest or not steps:
        below, above = max(steps, 1) * period / NANOSECONDS, max(steps + 1, 2) * period / NANOSECONDS
        raise SpecError(
            f"not a multiple of control_period {control_period:g} s",
            key=key,
            value=duration,
            accepted=f"e.g. {below:g} or {above:g}",
        )
    return steps
