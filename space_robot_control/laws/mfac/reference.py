"""Model-free adaptive control on one screen: (15)-(19) of Song, Zheng, Guo, Yuan, Aerospace 10(1):90, 2023, corrected.

y has the channels of ``pd/reference.py``; y* - y is their error e, and the output is e or, with a lead c, z = e + c e'.
Not in the paper and nevertheless here: the law takes increments of the error, the estimator those of the robot's own
motion, and both in units of their own. Errata: docs/papers/song2023.md. Not in the paper and so not here: limits and
anti-windup, ``filter``, ``adjust``, ``initial`` by push or pulses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from space_robot_control.laws.pd.reference import channel_errors, response
from space_robot_msgs_py.interfaces import Vector


@dataclass(eq=False)
class Mfac:
    """Control law (16) and estimator (17) of Phi = [phi_1 .. phi_{Ly+Lu}], each (m, m)."""

    model: Any  # the nominal pin.Model, free-flyer root, no gravity
    T: float  # control period [s]
    channels: list[int]  # indices into v, one input and one output each
    rho: Vector  # (m,) rho_{Ly+1}; all other rho are 1
    kappa: Vector  # (m,) lambda / phi^2
    limit: Vector  # (m,) of the inputs, for units full_scale
    c: Vector | None = None  # (m,) lead [s]; None: the output is e
    held: Sequence[int] = ()  # indices of joints taken as rigid
    home: Sequence[float] = ()  # where they stand [rad or m]
    lambda_: float = 0.0  # lambda itself, added
    orders: tuple[int, int] = (2, 1)  # Ly, Lu
    sigma: float = 0.2  # step of the estimator; 0: Phi stays Phi(1)
    beta: float = 1.0
    floor: float = 0.1  # share of Phi(1) below which Phi is reset
    scale: float = 1.0  # factor on Phi(1)
    units: Literal["full_scale", "printed"] = "full_scale"  # an input's limit and its effect in T; deg, mm, N m, N
    Phi: Vector | None = field(default=None, init=False)
    last: tuple[Vector, Vector, Vector, Vector] | None = field(default=None, init=False)  # q, v, e', desired v

    def start(self, q: Vector) -> None:
        """Phi(1) of y'' = B u, (19), in the units of the law: past increments of y, then of u."""
        self.m, (L_y, L_u), T = len(self.channels), self.orders, self.T
        E, zero = np.eye(self.m), np.zeros((self.m, self.m))
        B = self.scale * response(self.model, q, self.channels, self.held, self.home)
        if self.c is not None:  # z(k+1) - z(k) = z(k) - z(k-1) + T (c + T/2) B du
            phi, past, inputs = T * np.diag(self.c + T / 2) @ B, [E, zero], 1
        else:  # y(k+1) - y(k) = 2 (y(k) - y(k-1)) - (y(k-1) - y(k-2)) + T^2/2 B (du(k) + du(k-1)); one input: T^2 B
            phi, past, inputs = T**2 * B / (2 if L_u > 1 else 1), [2 * E, -E], min(2, L_u)
        blocks_y = [*past, *[zero] * L_y][:L_y]
        blocks_u = [*[phi] * inputs, *[zero] * L_u][:L_u]
        lengths = np.array(self.channels) < 3
        S_y, S_u = np.where(lengths, 1000.0, 180.0 / np.pi), np.ones(self.m)
        if self.units == "full_scale":
            S_y, S_u = 1.0 / (np.abs(np.diag(phi)) * self.limit), self.limit
        self.S_y, self.S_u = np.diag(S_y), np.diag(S_u)
        from_y = [self.S_y @ block @ np.linalg.inv(self.S_y) for block in blocks_y]
        self.Phi_1 = np.hstack([*from_y, *(self.S_y @ block @ self.S_u for block in blocks_u)])
        self.Phi, self.u, self.z = self.Phi_1, np.zeros(self.m), np.zeros(self.m)
        self.dy, self.du = [np.zeros(self.m)] * L_y, [np.zeros(self.m)] * L_u  # of the law, newest first
        self.own_dy = list(self.dy)  # of the estimator

    def phi(self, i: int) -> Vector:
        """Return phi_{i+1} (m, m)."""
        assert self.Phi is not None
        return self.Phi[:, self.m * i : self.m * (i + 1)]

    def update(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector) -> Vector:
        """Return u (6+n,), zero where there is no channel."""
        if self.Phi is None:
            self.start(q)
        (L_y, L_u), c = self.orders, np.zeros(self.m) if self.c is None else self.c
        e, e_dot, desired = channel_errors(q, v, q_d, v_d, self.channels)
        if self.last is not None:
            q_0, v_0, e_dot_0, desired_0 = self.last
            e_0, _, _ = channel_errors(q_0, v_0, q_d, v_d, self.channels)  # the last state against this reference
            own = (e_0 - e) + c * ((desired - desired_0) - (e_dot - e_dot_0))
            self.estimate(self.S_y @ own)
        z = e + c * e_dot
        self.dy = [-self.S_y @ (z - self.z), *self.dy][:L_y]
        past = np.zeros(self.m)
        past += sum(self.phi(i) @ self.dy[i] for i in range(L_y))
        past += sum(self.phi(L_y + i) @ self.du[i - 1] for i in range(1, L_u))
        phi, weight = self.phi(L_y), np.diag(1.0 + self.kappa)
        W = phi.T @ weight @ phi + self.lambda_ * np.eye(self.m)
        phi_1 = self.Phi_1[:, self.m * L_y : self.m * (L_y + 1)]
        least, smallest = self.floor * np.linalg.svd(phi_1)[1].min(), np.linalg.svd(phi)[1].min()
        W += max(0.0, least**2 - smallest**2) * np.eye(self.m)
        du = np.linalg.inv(W) @ phi.T @ (self.rho * (self.S_y @ z) - past)  # (16)
        self.z, self.last, self.u, self.du = z, (q, v, e_dot, desired), self.u + du, [du, *self.du][:L_u]
        out = np.zeros(self.model.nv)
        out[self.channels] = self.S_u @ self.u
        return out

    def estimate(self, dy: Vector) -> None:
        """Correct Phi along dH by what it did not predict, (17), with the reset of Hou."""
        L_y, dH = self.orders[0], np.concatenate([*self.own_dy, *self.du])
        self.own_dy = [dy, *self.own_dy][:L_y]
        if self.sigma == 0.0 or dH @ dH < 1e-12:
            return
        self.Phi = self.Phi + self.sigma * np.outer(dy - self.Phi @ dH, dH) / (self.beta + dH @ dH)
        phi_1 = self.Phi_1[:, self.m * L_y : self.m * (L_y + 1)]
        if np.diag(self.phi(L_y) @ np.linalg.inv(phi_1)).min() < self.floor:
            self.Phi = self.Phi_1
