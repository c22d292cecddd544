"""Momentum and energy of a grasped robot compared with the work and impulse done on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_msgs_py.interfaces import Vector


class ConservationBalance:
    """Residuals since the start of a run, relative to the largest sum of the bodies' own magnitudes so far.

    Args:
        model: ``pin.Model`` of the true robot.
    """

    def __init__(self, model: Any) -> None:
        self._model, self._data = model, model.createData()
        self.reset()

    def reset(self) -> None:
        """Take the next state as the baseline."""
        self._first: Vector | None = None
        self._largest = np.zeros(3)

    def balance(self, q: Vector, v: Vector, wheels: Vector, done: Vector) -> tuple[Vector, float, Vector]:
        """Return momentum (6: linear, angular about the inertial origin, wheels included), energy and residuals (3).

        Args:
            q: (7+n,) configuration.
            v: (6+n,) velocity.
            wheels: (3,) momentum of the wheels relative to the base, body frame [N m s].
            done: (7,) work, impulse, angular impulse since the start.

        Returns:
            Momentum [N s, N m s], kinetic energy [J], relative residuals of linear and angular momentum and of energy.
        """
        pin.forwardKinematics(self._model, self._data, q, v)
        bodies = [
            self._data.oMi[i].act(self._model.inertias[i] * self._data.v[i]) for i in range(1, self._model.njoints)
        ]
        stored = self._data.oMi[1].rotation @ wheels
        momentum = np.sum([body.vector for body in bodies], axis=0)
        momentum[3:] += stored
        energy = 0.5 * sum(
            float((self._model.inertias[i] * self._data.v[i]).dot(self._data.v[i]))
            for i in range(1, self._model.njoints)
        )
        now = np.concatenate([momentum, [energy]])
        if self._first is None:
            self._first = now
        gross = [
            sum(float(np.linalg.norm(body.linear)) for body in bodies),
            sum(float(np.linalg.norm(body.angular)) for body in bodies) + float(np.linalg.norm(stored)),
            max(energy, abs(float(done[0]))),
        ]
        self._largest = np.maximum(self._largest, gross)
        gone = now - self._first - np.concatenate([done[1:], done[:1]])
        error = np.array([np.linalg.norm(gone[:3]), np.linalg.norm(gone[3:6]), abs(gone[6])])
        residuals = np.divide(error, self._largest, out=np.zeros(3), where=self._largest > 0.0)
        return momentum, energy, residuals
