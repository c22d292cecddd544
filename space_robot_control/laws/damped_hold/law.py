"""Damped hold: a damper on every degree of freedom that has an actuator, and nothing else."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from space_robot_control.laws.base import Blocks
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


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

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        moved, largest = self._inertia(state.q)
        rate = self.gains.rate / (1.0 + self.gains.rate * self.control_period * largest)
        damping = np.zeros(6 + self.n)
        damping[self._first :] = rate * moved
        u = -damping * state.v
        errors = tracking_errors(state, reference)
        return u, {**error_blocks(errors), "damping": damping, "power": float(state.v @ u)}

    def _inertia(self, q: Vector) -> tuple[Vector, float]:
        """(m,) inertia that each degree of freedom moves, and lambda, at a configuration (7+n,)."""
        inverse = np.linalg.inv(self._model.actuated_mass_matrix(q))
        moved = 1.0 / np.diag(inverse)
        root = np.sqrt(moved)
        largest = np.linalg.eigvalsh(root[:, None] * inverse * root)[-1]
        return moved, float(largest)
