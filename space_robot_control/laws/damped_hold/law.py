"""Damped hold: a damper on every degree of freedom that has an actuator, and nothing else."""

from __future__ import annotations

from typing import ClassVar

from space_robot_control.laws.compiled import CompiledLaw, Layout
from space_robot_control.laws.damped_hold.kernel.answer import HoldContext, answer, hold_work, keep
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.kernel.context import context_of


class DampedHold(RatesToZero):
    """u = -D v, D = diag(d) w / (1 + w T lambda): takes energy out from any state, follows nothing.

    d_i = 1 / (H^-1)_ii is the inertia that degree of freedom i moves while the others are free, lambda >= 1 the largest
    eigenvalue of H^-1 diag(d), both of the nominal inertia H at the state, with the translation eliminated where no
    force acts on the base. v^T u = -v^T D v <= 0 in every state. The law has no memory. The reference is not followed;
    errors to it are telemetry.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: rate.

    The equations on one screen: ``reference.py``.

    Deviations from the paper: there is none; this is the law a robot falls back to.
    """

    name = "damped_hold"
    gain_ranges: ClassVar[GainRanges] = {"rate": GainRange(0.02, 5.0)}
    telemetry_fields = ERROR_FIELDS | {
        "damping": "diagonal of D, zero where nothing acts [N s/m, N m s/rad]",
        "power": "v^T u, not positive [W]",
    }

    def form(self) -> CompiledLaw:
        """See ``kernel/answer.py``."""
        context = HoldContext(self.control_period, self.known, self.room, hold_work(self.actuated))
        layout = Layout.of({**self.errors, "damping": 6 + self.n, "power": 1})
        return CompiledLaw(answer, context_of(context, keep), layout)
