"""Paced mode: the steady clock says when a control period is over."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.parameters import ParameterRow

REALTIME = "realtime"
SLOWEST, FASTEST = 1e-3, 1e4


def realtime_row(factor: float | None) -> ParameterRow:
    """The parameter that says how fast a run is paced; 0: not paced, it goes as fast as commands come."""
    text = "simulated seconds per second of the steady clock; 0: lock-step, which cannot be changed during the run"
    if factor is None:
        return ParameterRow(REALTIME, 0.0, text)
    return ParameterRow(REALTIME, factor, text, dynamic=True, lower=SLOWEST, upper=FASTEST)


def checked_factor(value: Any) -> float:
    """A factor that was given at the start or during the run.

    Raises:
        SpecError: it is no number, or beyond the bounds.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not SLOWEST <= value <= FASTEST:
        raise SpecError("not a pace", key=REALTIME, value=value, accepted=f"{SLOWEST:g} to {FASTEST:g}")
    return float(value)


class Pacer:
    """Calls ``on_period`` every ``wall_period`` of the steady clock, which never jumps.

    Args:
        node: the node whose executor runs the timer.
        wall_period: [ns] of the steady clock.
        on_period: what to do then.
    """

    def __init__(self, node: Node, wall_period: float, on_period: Callable[[], None]) -> None:
        self._timer = node.create_timer(wall_period * 1e-9, on_period, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def pace(self, wall_period: float) -> None:
        """Another length [ns] from the period that begins now on."""
        self._timer.timer_period_ns = round(wall_period)
        self._timer.reset()

    def restart(self) -> None:
        """A whole period from now on: a run that starts gives its controller the same time as later."""
        self._timer.reset()
