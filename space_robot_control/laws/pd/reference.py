"""PD on one screen: the equations of ``ProportionalDerivative`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer, see ``computed_torque/reference.py``. A channel is an index into v: 0 to 2 base
translation, 3 to 5 base rotation, 6 and up the joints. Not here: ``filter``, rates from positions and the gate.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from space_robot_control.laws.computed_torque.reference import attitude, error_quaternion, mass_and_bias
from space_robot_msgs_py.interfaces import Vector


def channel_errors(
    q: Vector, v: Vector, q_d: Vector, v_d: Vector, channels: Sequence[int]
) -> tuple[Vector, Vector, Vector]:
    """Return e, e' (m,), desired minus actual in the actual body frame, and the desired velocity there (m,).

    e is R^T (p_d - p), 2 eps of the error quaternion, and q_d - q.
    """
    R, R_d = attitude(q), attitude(q_d)
    R_e = R.T @ R_d
    e = np.concatenate([R.T @ (q_d[:3] - q[:3]), 2.0 * error_quaternion(q, q_d)[:3], q_d[7:] - q[7:]])
    desired = np.concatenate([R_e @ v_d[:3], R_e @ v_d[3:6], v_d[6:]])
    chosen = list(channels)
    return e[chosen], (desired - v)[chosen], desired[chosen]


def response(
    model: Any, q: Vector, channels: Sequence[int], held: Sequence[int] = (), home: Sequence[float] = ()
) -> Vector:
    """Return B (m, m) of e'' = -B u at rest: rows and columns of the channels in M^-1, M without the held joints.

    These stand at ``home``, whatever is read of them.
    """
    q = np.array(q)
    q[[joint + 1 for joint in held]] = home
    M, _ = mass_and_bias(model, q, np.zeros(model.nv))
    free = [i for i in range(model.nv) if i not in held]
    inverse = np.zeros((model.nv, model.nv))
    inverse[np.ix_(free, free)] = np.linalg.inv(M[np.ix_(free, free)])
    B: Vector = inverse[np.ix_(list(channels), list(channels))]
    return B


class Pd:
    """u = B^-1 (omega_n^2 e + 2 zeta omega_n e'), B the response at the first configuration.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        channels: indices into v, one input and one output each.
        held: indices of joints taken as rigid.
        home: where they stand [rad or m].
        omega_n: (m,) natural frequencies [rad/s].
        zeta: damping ratio.
    """

    def __init__(
        self,
        model: Any,
        channels: Sequence[int],
        *,
        omega_n: Vector,
        zeta: float,
        held: Sequence[int] = (),
        home: Sequence[float] = (),
    ) -> None:
        self.model, self.channels, self.omega_n, self.zeta = model, list(channels), omega_n, zeta
        self.held, self.home = held, home
        self.B: Vector | None = None

    def update(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector) -> Vector:
        """Return u (6+n,), zero where there is no channel."""
        if self.B is None:
            self.B = response(self.model, q, self.channels, self.held, self.home)
        e, e_dot, _ = channel_errors(q, v, q_d, v_d, self.channels)
        K_p, K_d = np.diag(self.omega_n**2), np.diag(2.0 * self.zeta * self.omega_n)
        u = np.zeros(self.model.nv)
        u[self.channels] = np.linalg.inv(self.B) @ (K_p @ e + K_d @ e_dot)
        return u
