"""Reaction null space on one screen: the equations of ``ReactionNullSpace`` in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``. Not here: ``gyroscopic``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.computed_torque.reference import errors, mass_and_bias
from space_robot_control.laws.lqr.reference import actuated_mass
from space_robot_msgs_py.interfaces import Vector


class ReactionNullSpace:
    """u = M [a_b, a_J] + c, a_J = (s_1 - s) / T + w' (s - q'), s = (I + lambda^2 J^T J)^-1 (q_d' + k e).

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        T: control period [s].
        k: stiffness of the command of rates [1/s].
        w: rate with which joint rates go to it [1/s].
        omega_n: of the base [rad/s].
        weight: lambda.
        floating: no force acts on the base.
    """

    def __init__(
        self, model: Any, T: float, *, k: float, w: float, omega_n: float, weight: float, floating: bool
    ) -> None:
        self.model, self.T, self.k, self.weight, self.floating = model, T, k, weight, floating
        self.w, self.omega_n = w / (1.0 + w * T), omega_n / (1.0 + omega_n * T)

    def jacobian(self, q: Vector) -> Vector:
        """Return J = -H_b^-1 H_bm, the generalised Jacobian of the base."""
        H, b = actuated_mass(self.model, q, self.floating), 3 if self.floating else 6
        J: Vector = -np.linalg.inv(H[:b, :b]) @ H[:b, b:]
        return J

    def filtered(self, q: Vector, r: Vector) -> Vector:
        """Return (I + lambda^2 J^T J)^-1 r."""
        J = self.jacobian(q)
        return np.array(np.linalg.solve(np.identity(len(r)) + self.weight**2 * J.T @ J, r))

    def update(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> Vector:
        """Return u (6+n,)."""
        T, k = self.T, self.k
        e_x, e_v, feedforward = errors(q, v, q_d, v_d, a_d)
        q_1 = np.concatenate([q[:7], q[7:] + T * v[6:]])
        s = self.filtered(q, v_d[6:] + k * e_x[6:])
        s_1 = self.filtered(q_1, v_d[6:] + T * a_d[6:] + k * (e_x[6:] + T * e_v[6:]))
        a_J = (s_1 - s) / T + self.w * (s - v[6:])
        a_b = feedforward[:6] + 2.0 * self.omega_n * e_v[:6] + self.omega_n**2 * e_x[:6]
        a = np.concatenate([a_b, a_J])

        M, c = mass_and_bias(self.model, q, v)
        if self.floating:
            a[:3] = -np.linalg.solve(M[:3, :3], M[:3, 3:] @ a[3:] + c[:3])
        u: Vector = M @ a + c
        if self.floating:
            u[:3] = 0.0
        return u
