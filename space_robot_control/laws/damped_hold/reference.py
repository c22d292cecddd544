"""Damped hold on one screen: the equations of ``DampedHold`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.computed_torque.reference import mass_and_bias
from space_robot_msgs_py.interfaces import Vector


def inertia(model: Any, q: Vector, *, floating: bool) -> Vector:
    """Return H: M, or what is left of it for base rotation and joints while no force acts on the base."""
    M, _ = mass_and_bias(model, q, np.zeros(model.nv))
    if not floating:
        return M
    M_ll, M_lr, M_rr = M[:3, :3], M[:3, 3:], M[3:, 3:]
    H: Vector = M_rr - M_lr.T @ np.linalg.inv(M_ll) @ M_lr
    return H


class DampedHold:
    """u = -D v with D = diag(d) w / (1 + w T lambda), d_i = 1 / (H^-1)_ii, lambda = max eig (H^-1 diag(d)).

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        omega: w [1/s].
        T: control period [s].
        floating: no force acts on the base.
    """

    def __init__(self, model: Any, *, omega: float, T: float, floating: bool) -> None:
        self.model, self.omega, self.T, self.floating = model, omega, T, floating

    def update(self, q: Vector, v: Vector) -> Vector:
        """Return u (6+n,)."""
        H_inverse = np.linalg.inv(inertia(self.model, q, floating=self.floating))
        d = np.diag(1.0 / np.diag(H_inverse))
        largest = np.linalg.eigvals(H_inverse @ d).real.max()
        D = np.zeros((self.model.nv, self.model.nv))
        first = self.model.nv - d.shape[0]
        D[first:, first:] = d * self.omega / (1.0 + self.omega * self.T * largest)
        u: Vector = -D @ v
        return u
