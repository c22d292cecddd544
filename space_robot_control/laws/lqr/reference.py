"""LQR on one screen: the equations of ``Lqr`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``. Not here: ``gyroscopic``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.computed_torque.reference import computed_torque, errors, mass_and_bias
from space_robot_msgs_py.interfaces import Vector


def actuated_mass(model: Any, q: Vector, floating: bool) -> Vector:
    """Return M (m, m) of the actuated degrees of freedom; without a force on the base its translation is eliminated."""
    M, _ = mass_and_bias(model, q, np.zeros(model.nv))
    if not floating:
        return M
    M_r: Vector = M[3:, 3:] - M[3:, :3] @ np.linalg.inv(M[:3, :3]) @ M[:3, 3:]
    return M_r


def sampled_model(M: Vector, T: float) -> tuple[Vector, Vector]:
    """Return A (2m, 2m), B (2m, m) of [e, e']_{k+1} = A [e, e']_k + B w_k, e'' = -M^-1 w and w held over T."""
    one, zero = np.identity(len(M)), np.zeros_like(M)
    inverse = np.linalg.inv(M)
    A = np.block([[one, T * one], [zero, one]])
    B = np.vstack([-(T**2) / 2.0 * inverse, -T * inverse])
    return A, B


def riccati(A: Vector, B: Vector, Q: Vector, R: Vector) -> tuple[Vector, Vector]:
    """Return X and K of u = -K x with the least sum of x^T Q x + u^T R u: dynamic programming to its fixed point."""
    X = Q
    for _ in range(2000):
        K = np.array(np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A))
        before, X = X, Q + A.T @ X @ (A - B @ K)
        X = (X + X.T) / 2.0
        if np.abs(X - before).max() <= 1e-13 * np.abs(X).max():
            break
    return X, K


class Lqr:
    """u = M0 a_ff + c0 - K [e_x, e_v], K of the posture.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        T: control period [s].
        error: (m,) accepted errors of the actuated degrees of freedom.
        tau: [s] they may take.
        effort: (m,) limits of the actuators.
        step: motion of a joint after which K is computed again.
        floating: no force acts on the base.
    """

    def __init__(
        self, model: Any, T: float, *, error: Vector, tau: float, effort: Vector, step: float, floating: bool
    ) -> None:
        self.model, self.T, self.step, self.floating = model, T, step, floating
        self.Q = np.diag(np.concatenate([1.0 / error**2, (tau / error) ** 2]))
        self.R = np.diag(1.0 / effort**2)
        self.posture: Vector | None = None

    def design(self, q: Vector) -> None:
        """Compute K where the arm has left the posture of the last one."""
        if self.posture is None or np.abs(q[7:] - self.posture).max() > self.step:
            self.posture = np.array(q[7:])
            self.A, self.B = sampled_model(actuated_mass(self.model, q, self.floating), self.T)
            self.X, self.K = riccati(self.A, self.B, self.Q, self.R)

    def update(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> Vector:
        """Return u (6+n,)."""
        self.design(q)
        e_x, e_v, _ = errors(q, v, q_d, v_d, a_d)
        # Without feedback: bandwidth 0.
        u = computed_torque(
            self.model, q, v, q_d, v_d, a_d, omega_n=np.zeros_like(v), zeta=1.0, free_floating=self.floating
        )
        first = 3 if self.floating else 0
        u[first:] += self.feedback(np.concatenate([e_x[first:], e_v[first:]]), u[first:])
        return u

    def feedback(self, x: Vector, u_ff: Vector) -> Vector:
        """Return w (m,)."""
        del u_ff
        w: Vector = -self.K @ x
        return w
