"""Momentum and energy of a grasped robot compared with the work and impulse done on it."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from space_robot_description.kernel.arrays import robot_arrays
from space_robot_description.kernel.jit import bound
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.articulated import WORKSPACE
from space_robot_sim.kernel.momentum import BALANCE_SIZE, ENERGY, GROSS_ANGULAR, GROSS_LINEAR, balance


class ConservationBalance:
    """Residuals since the start of a run, relative to the largest sum of the bodies' own magnitudes so far.

    Args:
        model: ``pin.Model`` of the true robot.
    """

    def __init__(self, model: Any) -> None:
        self._robot = robot_arrays(model)
        self._work, self._now = np.zeros((len(self._robot.tree), WORKSPACE)), np.zeros(BALANCE_SIZE)
        # All wheels as one, whose axis has the length of their momentum.
        self._axis, self._one, y = np.zeros((3, 1)), np.ones(1), np.zeros(model.nq + model.nv)
        self._balance = bound(balance, self._robot, y, self._axis, self._one, self._work, self._now)
        self.reset()

    def reset(self) -> None:
        """Take the next state as the baseline."""
        self._first: list[float] | None = None
        self._largest = [0.0, 0.0, 0.0]

    def balance(self, motion: Vector, wheels: Vector, done: Vector) -> tuple[Vector, float, Vector]:
        """Return momentum (6: linear, angular about the inertial origin, wheels included), energy and residuals (3).

        Args:
            motion: (13+2n,) configuration and velocity.
            wheels: (3,) momentum of the wheels relative to the base, body frame [N m s].
            done: (7,) work, impulse, angular impulse since the start.

        Returns:
            Momentum [N s, N m s], kinetic energy [J], relative residuals of linear and angular momentum and of energy.
        """
        self._axis[:, 0] = wheels
        self._balance(self._robot, motion, self._axis, self._one, self._work, self._now)
        now, (work, *impulse) = self._now.tolist(), done.tolist()
        if self._first is None:
            self._first = now
        gross = now[GROSS_LINEAR], now[GROSS_ANGULAR], max(now[ENERGY], abs(work))
        self._largest = [max(pair) for pair in zip(self._largest, gross, strict=True)]
        gone = [a - b - c for a, b, c in zip(now[: ENERGY + 1], self._first, (*impulse, work), strict=False)]
        error = _norm(gone[:3]), _norm(gone[3:6]), abs(gone[6])
        residuals = [a / b if b > 0.0 else 0.0 for a, b in zip(error, self._largest, strict=True)]
        return self._now[:6].copy(), now[ENERGY], np.array(residuals)


def _norm(a: list[float]) -> float:
    return sqrt(sum(x * x for x in a))
