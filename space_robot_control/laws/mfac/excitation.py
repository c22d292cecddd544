"""Inputs that let the initial value be found: a push towards the target, or pulses, one input after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Push:
    """All inputs at once, each towards its target: the first arc of a step response.

    Attributes:
        ticks: how many control periods.
        size: (m,) of the push.
    """

    ticks: int
    size: Vector

    def at(self, tick: int, error: Vector) -> Vector:
        """(m,) input at a tick; ``error`` (m,) is that of the first."""
        del tick
        return self.size * np.sign(error)


@dataclass(frozen=True, eq=False, slots=True)
class Pulses:
    """+, -, -, + on one input after the other: it ends at rest where it began.

    Attributes:
        quarter: control periods of one sign.
        size: (m,) of the pulses.
    """

    quarter: int
    size: Vector

    @property
    def ticks(self) -> int:
        """How many control periods."""
        return 4 * self.quarter * self.size.size

    def at(self, tick: int, error: Vector) -> Vector:
        """(m,) input at a tick."""
        channel, phase = divmod(tick // self.quarter, 4)
        out = np.zeros(error.size)
        out[channel] = self.size[channel] * (1.0 if phase in (0, 3) else -1.0)
        return out
