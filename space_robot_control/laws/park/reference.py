"""Park on one screen: the equations of ``Park`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``. Not here: saturation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.damped_hold.reference import inertia
from space_robot_msgs_py.interfaces import Vector


class Park:
    """u = H a, a = [-w' v_b, (r+ - r)/T + w' (r - q') + w'^2/4 (p - q)], w' = w / (1 + w T), p+ = p + T r+.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        omega: w [1/s].
        v_max: largest rate on the path [rad/s or m/s].
        A: largest acceleration on the path [rad/s2 or m/s2].
        q_p: (n,) the posture [rad or m].
        T: control period [s].
        floating: no force acts on the base.
    """

    def __init__(
        self, model: Any, *, omega: float, v_max: float, A: float, q_p: Vector, T: float, floating: bool
    ) -> None:
        self.model, self.floating, self.w = model, floating, omega / (1.0 + omega * T)
        self.v_max, self.A, self.q_p, self.T = v_max, A, q_p, T
        self.p: Vector | None = None

    def update(self, q: Vector, v: Vector) -> Vector:
        """Return u (6+n,)."""
        if self.p is None:
            self.p, self.r = q[7:].copy(), v[6:].copy()
        a, r_next = -self.w * v, np.empty_like(self.r)
        for i, e in enumerate(self.q_p - self.p):
            k = np.sqrt(0.25 + 2.0 * abs(e) / (self.A * self.T**2)) - 0.5
            r_star = np.sign(e) * min(self.v_max, self.A * self.T * k, abs(e) / self.T)
            r_next[i] = self.r[i] + max(-self.A * self.T, min(self.A * self.T, r_star - self.r[i]))
        a[6:] = (r_next - self.r) / self.T + self.w * (self.r - v[6:]) + self.w**2 / 4.0 * (self.p - q[7:])
        self.p, self.r = self.p + self.T * r_next, r_next
        H = inertia(self.model, q, floating=self.floating)
        u, first = np.zeros(self.model.nv), self.model.nv - H.shape[0]
        u[first:] = H @ a[first:]
        return u
