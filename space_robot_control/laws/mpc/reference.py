"""Linear MPC on one screen: the equations of ``LinearMpc`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``lqr/reference.py``. Not here: ``gyroscopic``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_control.laws.lqr.reference import Lqr
from space_robot_msgs_py.interfaces import Vector


def condensed(A: Vector, B: Vector, Q: Vector, R: Vector, X: Vector, N: int) -> tuple[Vector, Vector]:
    """Return H, F of 1/2 w^T H w + (F x)^T w = half of sum x_k^T Q x_k + w_k^T R w_k + x_N^T X x_N, w of N periods."""
    s, m = B.shape
    Phi = np.vstack([np.linalg.matrix_power(A, k + 1) for k in range(N)])
    Gamma = np.zeros((N * s, N * m))
    for k in range(N):
        for j in range(k + 1):
            Gamma[k * s : (k + 1) * s, j * m : (j + 1) * m] = np.linalg.matrix_power(A, k - j) @ B
    Q_bar = np.kron(np.identity(N), Q)
    Q_bar[-s:, -s:] = X
    return Gamma.T @ Q_bar @ Gamma + np.kron(np.identity(N), R), Gamma.T @ Q_bar @ Phi


def least(H: Vector, f: Vector, C: Vector, d: Vector, sweeps: int = 20_000) -> Vector:
    """Return the w of least 1/2 w^T H w + f^T w with C w <= d: Hildreth's coordinate ascent on the dual."""
    P, r = C @ np.linalg.solve(H, C.T), d + C @ np.linalg.solve(H, f)
    y = np.zeros(len(d))
    for _ in range(sweeps):
        before = y.copy()
        for i in range(len(d)):
            y[i] = max(0.0, y[i] - (P[i] @ y + r[i]) / P[i, i])
        if np.abs(y - before).max() <= 1e-14 * max(1.0, np.abs(y).max()):
            break
    return -np.array(np.linalg.solve(H, f + C.T @ y))


class Mpc(Lqr):
    """u = M0 a_ff + c0 + w_0 with -limit <= S (u_ff + w_k) <= limit in each of N periods.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        T: control period [s].
        N: periods that are looked ahead.
        S: (l, m) what is limited, of the actuated degrees of freedom.
        limit: (l,) its limits.
        regulator: as of ``Lqr``.
    """

    def __init__(self, model: Any, T: float, *, N: int, S: Vector, limit: Vector, **regulator: Any) -> None:
        super().__init__(model, T, **regulator)
        self.N, self.S, self.limit = N, S, limit

    def feedback(self, x: Vector, u_ff: Vector) -> Vector:
        """Return w_0 (m,)."""
        H, F = condensed(self.A, self.B, self.Q, self.R, self.X, self.N)
        every = np.kron(np.identity(self.N), self.S)
        C = np.vstack([every, -every])
        there = np.tile(self.S @ u_ff, self.N)
        d = np.concatenate([np.tile(self.limit, self.N) - there, np.tile(self.limit, self.N) + there])
        return least(H, F @ x, C, d)[: len(u_ff)]
