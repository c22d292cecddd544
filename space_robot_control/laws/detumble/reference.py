"""Detumble on one screen: the equations of ``Detumble`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``. Not here: saturation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.damped_hold.reference import inertia
from space_robot_msgs_py.interfaces import Vector


class Detumble:
    """u = H a, a = -w' v - w'^2 / 4 [0, q - q0], w' = w / (1 + w T).

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        omega: w [1/s].
        T: control period [s].
        floating: no force acts on the base.
    """

    def __init__(self, model: Any, *, omega: float, T: float, floating: bool) -> None:
        self.model, self.floating, self.w = model, floating, omega / (1.0 + omega * T)
        self.q_0: Vector | None = None

    def update(self, q: Vector, v: Vector) -> Vector:
        """Return u (6+n,)."""
        if self.q_0 is None:
            self.q_0 = q[7:].copy()
        H = inertia(self.model, q, floating=self.floating)
        a = -self.w * v - self.w**2 / 4.0 * np.concatenate([np.zeros(6), q[7:] - self.q_0])
        u, first = np.zeros(self.model.nv), self.model.nv - H.shape[0]
        u[first:] = H @ a[first:]
        return u
