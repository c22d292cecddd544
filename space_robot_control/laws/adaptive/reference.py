"""Adaptive control on one screen: (29)-(45) of Liu, Teng and Jin, Aerospace 10, 679, 2023, corrected.

x = [position inertial, yaw, pitch, roll, joints], R = Rz Ry Rx; pi has [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] about the
joint origin, body after body, base first. Arguments q, v, a are Pinocchio's free-flyer: v = G x', u = G^-T tau. Errata:
docs/papers/liu2023.md. Not in the paper and so not here: ``lead``, ``gyroscopic``, ``consistency``, ``rls.reset``, and
that RLS leaves out a period whose command was beyond the actuators.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pinocchio as pin

from space_robot_control.laws.adaptive.reference_dynamics import Dynamics, euler, short_way
from space_robot_msgs_py.interfaces import Vector


class Adaptive:
    """u = Y pi_hat + K_D sigma (38), with pi_hat by RLS (39)-(41), the Lyapunov update (44), or both.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        T: control period [s].
        Lambda: (m,) of the actuated coordinates.
        kappa: K_D = kappa M(pi_0, x_0), reduced by a free translation.
        update: composite: RLS, and (44) with Gamma = gamma times the covariance; rls_filtered: RLS on both sides of the
            regression behind the filter b / (s + b), which Slotine and Li use (1991, sec. 8.7.1).
        lambda_on: velocity: sigma = Lambda e' + e.
        free_floating: no force acts on the base; its translation follows from the rows of zero force.
        translation: acceleration of a free base in RLS; on a free-flying one always velocity.
        noise: (m,) standard deviation of the rows of RLS, E = diag(noise^2).
        prior: standard deviation of pi in RLS: prior[0] |pi| + prior[1].
        b: bandwidth of the filter [rad/s].
        gamma: of Gamma = gamma diag((|pi| + floor)^2).
        floor: see gamma.
    """

    def __init__(
        self,
        model: Any,
        T: float,
        *,
        Lambda: Vector,
        kappa: float = 1.0,
        update: Literal["none", "rls", "rls_filtered", "lyapunov", "composite"] = "rls",
        lambda_on: Literal["position", "velocity"] = "position",
        free_floating: bool = True,
        translation: Literal["model", "accelerometer", "velocity"] = "model",
        noise: Vector | float = 1e-3,
        prior: tuple[float, float] = (0.3, 1e-3),
        b: float = 0.3,
        gamma: float = 1000.0,
        floor: float = 1e-3,
    ) -> None:
        self.model, self.T, self.Lambda, self.kappa, self.update_by = model, T, np.diag(Lambda), kappa, update
        self.first, self.on_velocity = 3 if free_floating else 0, lambda_on == "velocity"
        self.translation = translation if free_floating else "velocity"
        self.pi_hat = np.concatenate([model.inertias[i].toDynamicParameters() for i in range(1, model.njoints)])
        self.E, self.gamma = np.diag(np.full(Lambda.size, noise) ** 2), gamma
        self.G = np.diag((prior[0] * np.abs(self.pi_hat) + prior[1]) ** 2)
        self.Gamma = gamma * np.diag((np.abs(self.pi_hat) + floor) ** 2)
        self.a = np.exp(-b * T) if update == "rls_filtered" else 0.0
        self.Y_f, self.tau_f = np.zeros((Lambda.size, self.pi_hat.size)), np.zeros(Lambda.size)
        self.K_D: Vector | None = None
        self.last: tuple[Vector, Vector, Vector] | None = None

    def update(
        self, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector, effort: Vector, acceleration: Vector
    ) -> Vector:
        """Return u (6+n,), dual to v; effort (n,) as measured, acceleration (3,) of an accelerometer in the base."""
        first = self.first
        x, dx, _ = euler(q, v, np.zeros_like(v))
        x_d, dx_d, ddx_d = euler(q_d, v_d, a_d)
        if self.last is not None and self.update_by in ("rls", "rls_filtered", "composite"):
            self.rls(x, dx, effort, pin.Quaternion(q[3:7]).matrix() @ acceleration)
        at = Dynamics(self.model, x, dx)
        if self.K_D is None:
            M, m = at.M(self.pi_hat), at.mass(self.pi_hat)
            self.K_D = self.kappa * (M[first:, first:] - M[first:, :first] @ M[:first, first:] / m)

        e, de = short_way(x_d - x)[first:], (dx_d - dx)[first:]
        dx_r, ddx_r = np.concatenate([np.zeros(first), dx_d[first:]]), np.concatenate([np.zeros(first), ddx_d[first:]])
        sigma = self.Lambda @ de + e if self.on_velocity else de + self.Lambda @ e  # (33)
        if not self.on_velocity:
            dx_r[first:] += self.Lambda @ e  # (32)
            ddx_r[first:] += self.Lambda @ de
        if first:  # rows of zero force: p_r'' = -(Y_p pi_hat) / m_hat, sigma_p = -(M_pr sigma) / m_hat
            ddx_r[:3] = -(at.Y(dx_r, ddx_r)[:3] @ self.pi_hat) / at.mass(self.pi_hat)
        sigma_p = -(at.M(self.pi_hat)[:first, first:] @ sigma) / at.mass(self.pi_hat)
        Y = at.Y(dx_r, ddx_r)
        tau = Y @ self.pi_hat + np.concatenate([np.zeros(first), self.K_D @ sigma])  # (38)
        u: Vector = np.linalg.solve(at.G.T, tau)
        u[:first] = 0.0
        self.sigma, self.pi_used, self.last = sigma, self.pi_hat, (x, dx, u)
        if self.update_by in ("lyapunov", "composite"):  # (44), forward Euler
            Gamma = self.gamma * self.G if self.update_by == "composite" else self.Gamma
            self.pi_hat = self.pi_hat + self.T * Gamma @ Y.T @ np.concatenate([sigma_p, sigma])
        return u

    def rls(self, x: Vector, dx: Vector, effort: Vector, acceleration: Vector) -> None:
        """(39)-(41) on the period that ends in x: its middle, x'' from differences, the command that was held."""
        assert self.last is not None
        (x_0, dx_0, u), first = self.last, self.first
        at = Dynamics(self.model, x_0 + 0.5 * short_way(x - x_0), 0.5 * (dx_0 + dx))
        ddx = (dx - dx_0) / self.T
        if self.translation == "accelerometer":
            ddx[:3] = acceleration
        elif self.translation == "model":
            ddx[:3] = 0.0
            ddx[:3] = -(at.Y(at.dx, ddx)[:3] @ self.pi_hat) / at.mass(self.pi_hat)
        Y, tau = at.Y(at.dx, ddx)[first:], (at.G.T @ np.concatenate([u[:6], effort]))[first:]
        Y = self.Y_f = self.a * self.Y_f + (1.0 - self.a) * Y
        tau = self.tau_f = self.a * self.tau_f + (1.0 - self.a) * tau
        K = self.G @ Y.T @ np.linalg.inv(Y @ self.G @ Y.T + self.E)  # (40)
        self.pi_hat = self.pi_hat + K @ (tau - Y @ self.pi_hat)  # (39)
        I_KY = np.eye(self.pi_hat.size) - K @ Y
        self.G = I_KY @ self.G @ I_KY.T + K @ self.E @ K.T  # (41), in the form that stays positive definite
