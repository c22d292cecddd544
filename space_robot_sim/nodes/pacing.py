"""Paced mode: the steady clock says when a control period is over."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node


class Pacer:
    """Calls ``on_period`` every ``wall_period`` of the steady clock, which never jumps.

    Args:
        node: the node whose executor runs the timer.
        wall_period: [ns] of the steady clock.
        on_period: what to do then.
    """

    def __init__(self, node: Node, wall_period: float, on_period: Callable[[], None]) -> None:
        self._timer = node.create_timer(wall_period * 1e-9, on_period, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def restart(self) -> None:
        """A whole period from now on: a run that starts gives its controller the same time as later."""
        self._timer.reset()
