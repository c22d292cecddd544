"""Non-singular terminal sliding mode on one screen: (10)-(29) of Giordano and Cenedese, arXiv 2305.15007, corrected.

x' = [v_b, w_b, q'] has base parts in the inertial frame; errors are actual minus desired. Arguments q, v, a are
Pinocchio's free-flyer: v = G x', hence M0 = G^T M G and C0 = G^T (c + M G' x'). Errata: docs/papers/giordano2023.md.
Not in the paper and so not here: ``gyroscopic``; off by default clamp, leak, cap, freeze, saturation, the observer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from space_robot_control.laws.computed_torque.reference import attitude, mass_and_bias
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True)
class Gains:
    """Table I, but for K_2 of elbow (0.2) and wrist (0.6); Gamma and K_2 are one number, or (m,), one per DoF."""

    Gamma: float | Vector = 0.1
    K_1: float = 1e-2
    K_2: float | Vector = 0.1
    Phi: float = 1e-3  # half width of the boundary layer
    phi: float = 1e-3  # rate of K_hat
    K_hat_0: float = 1e-4
    r: float = 11 / 9  # q/p
    p1_q1: float = 5 / 9
    p2_q2: float = 7 / 9


class Attitude(NamedTuple):
    """The base rotation in some representation: G and G' (3, 3), errors (3,) and the desired acceleration (3,)."""

    G: Vector
    G_dot: Vector
    rate: Vector  # x' of the rotation
    e: Vector
    de: Vector  # the rate that s is made of
    e_dot: Vector  # the derivative of e
    ddx_d: Vector


def quaternion(q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> Attitude:
    """E = sgn+(eta_e) eps_e of the error quaternion q_e = q_b q_bd^-1, x' = w_b, (14)."""
    R, R_d = attitude(q), attitude(q_d)
    w_b, w_d = R @ v[3:6], R_d @ v_d[3:6]
    q_e = (pin.Quaternion(q[3:7]) * pin.Quaternion(q_d[3:7]).conjugate()).coeffs()
    eps_e, eta_e, sgn = q_e[:3], q_e[3], -1.0 if q_e[3] < 0.0 else 1.0
    eps_e_dot = 0.5 * (eta_e * (w_b - w_d) - np.cross(eps_e, w_b + w_d))
    return Attitude(R.T, -pin.skew(v[3:6]) @ R.T, w_b, sgn * eps_e, w_b - w_d, sgn * eps_e_dot, R_d @ a_d[3:6])


def sig(x: Vector, power: float) -> Vector:
    """sign(x) |x|^power."""
    return np.sign(x) * np.abs(x) ** power


class Ntsmc:
    """u = u_1 + u_2 + u_3, (27), (28), and K_hat, (29); the Euler baseline has the rotation of ``reference_euler.py``.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        T: control period [s].
        rotation: representation of the base rotation.
        free_floating: not in the paper; without a base force translation has no s and follows from zero force.
    """

    def __init__(
        self,
        model: Any,
        T: float,
        gains: Gains | None = None,
        rotation: Callable[[Vector, Vector, Vector, Vector, Vector], Attitude] = quaternion,
        *,
        free_floating: bool = False,
    ) -> None:
        self.model, self.T, self.gains, self.rotation = model, T, gains or Gains(), rotation
        self.first = 3 if free_floating else 0
        self.K_hat = np.full(model.nv - self.first, self.gains.K_hat_0)

    def update(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> Vector:
        """Return u (6+n,), dual to v; leaves s, Delta_s, xi (m,) and the next K_hat (m,)."""
        k, n, first = self.gains, self.model.nv - 6, self.first
        R, R_d, base = attitude(q), attitude(q_d), self.rotation(q, v, q_d, v_d, a_d)
        v_b, v_bd = R @ v[:3], R_d @ v_d[:3]
        dx = np.concatenate([v_b, base.rate, v[6:]])
        ddx_d = np.concatenate([R_d @ (a_d[:3] + np.cross(v_d[3:6], v_d[:3])), base.ddx_d, a_d[6:]])
        e = np.concatenate([q[:3] - q_d[:3], base.e, q[7:] - q_d[7:]])[first:]
        de = np.concatenate([v_b - v_bd, base.de, v[6:] - v_d[6:]])[first:]
        rot, speed2 = slice(3 - first, 6 - first), v[first:] @ v[first:]

        s = sig(de, k.r) / k.Gamma + e  # (10), (14), (25)
        sat = np.clip(s / k.Phi, -1.0, 1.0)
        Delta_s = s - k.Phi * sat  # (26)
        xi = np.abs(de) ** (k.r - 1) / k.Gamma * Delta_s
        a_2 = -k.Gamma / k.r * sig(de, 2 - k.r)  # (28b)
        w, Gamma_2 = np.abs(de[rot]) ** (k.r - 1), np.broadcast_to(k.Gamma, s.shape)[rot]
        a_2[rot] = -Gamma_2 / k.r * w / np.maximum(w**2, k.Phi) * base.e_dot
        toward = k.K_1 * xi / max(xi @ xi, k.Phi) * np.linalg.norm(Delta_s) ** (2 * k.p1_q1)
        a_3 = -(self.K_hat * sat * (1 + speed2) + toward + k.K_2 * sig(Delta_s, k.p2_q2))  # (28c)
        self.s, self.Delta_s, self.xi = s, Delta_s, xi
        self.K_hat = self.K_hat + self.T * k.phi * np.abs(xi) * (1 + speed2)  # (29)

        G, G_dot = np.eye(6 + n), np.zeros((6 + n, 6 + n))
        G[:3, :3], G[3:6, 3:6] = R.T, base.G
        G_dot[:3, :3], G_dot[3:6, 3:6] = -pin.skew(v[3:6]) @ R.T, base.G_dot
        M, c = mass_and_bias(self.model, q, v)
        M_0, C_0 = G.T @ M @ G, G.T @ (c + M @ G_dot @ dx)
        ddx = ddx_d + np.concatenate([np.zeros(first), a_2 + a_3])
        if first:
            ddx[:3] = -np.linalg.solve(M_0[:3, :3], M_0[:3, 3:] @ ddx[3:] + C_0[:3])
        u: Vector = np.linalg.solve(G.T, M_0 @ ddx + C_0)
        u[:first] = 0.0
        return u
