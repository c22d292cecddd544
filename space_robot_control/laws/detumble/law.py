"""Detumble: every rate to zero at one speed, while the arm keeps the shape it has at the first state."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from space_robot_control.laws.compiled import CompiledLaw, Layout
from space_robot_control.laws.detumble.kernel.answer import DetumbleContext, answer, keep
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.kernel.context import context_of


class Detumble(RatesToZero):
    """u = -s H (w' v + w'^2 / 4 [0, q - q0]), w' = w / (1 + w T): rates to zero, the arm stays where it was.

    H is the nominal inertia at the state, with the translation eliminated where no force acts on the base; q0 are the
    joints at the first state after a reset; s in (0, 1] scales the command until it fits the actuators. Base and joints
    do not disturb each other to first order in the rates. The reference is not followed; errors to it are telemetry.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: rate.

    The equations on one screen: ``reference.py``.

    Deviations from the paper: there is none; this is the law a robot falls back to.
    """

    name = "detumble"
    gain_ranges: ClassVar[GainRanges] = {"rate": GainRange(0.02, 5.0)}
    telemetry_fields = ERROR_FIELDS | {
        "joint_offset": "q - q0 [rad or m]",
        "scale": "s, less than 1 where the actuators cannot give the command [-]",
    }

    def form(self) -> CompiledLaw:
        """See ``kernel/answer.py``."""
        context = DetumbleContext(self.control_period, self.known, self.room, self.begun, np.zeros(self.n))
        layout = Layout.of({**self.errors, "joint_offset": self.n, "scale": 1})
        return CompiledLaw(answer, context_of(context, keep), layout)
