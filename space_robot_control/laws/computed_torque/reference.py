"""Computed torque on one screen: the equations of ``ComputedTorque`` with explicit matrices, in NumPy and Pinocchio.

Coordinates are Pinocchio's free-flyer: q = [position, quaternion (x, y, z, w), joints], v = [linear, angular, rates],
a = dv/dt, base parts in the body frame. Not here: ``gyroscopic``, the refusal of unstable gains.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_msgs_py.interfaces import Vector


def attitude(q: Vector) -> Vector:
    """Return R (3, 3), body to inertial."""
    R: Vector = pin.Quaternion(q[3:7]).matrix()
    return R


def error_quaternion(q: Vector, q_d: Vector) -> Vector:
    """Return (eps, eta) (4,) of R_e = R^T R_d, the short way: eta >= 0."""
    e: Vector = (pin.Quaternion(q[3:7]).conjugate() * pin.Quaternion(q_d[3:7])).coeffs()
    return -e if e[3] < 0.0 else e


def errors(q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> tuple[Vector, Vector, Vector]:
    """Return e_x, e_v, desired minus actual, and the feed-forward, (6+n,) each; base parts in the actual body frame."""
    R, R_d = attitude(q), attitude(q_d)
    R_e = R.T @ R_d
    linear, omega, linear_d, omega_d = v[:3], v[3:6], v_d[:3], v_d[3:6]

    *eps, eta = error_quaternion(q, q_d)
    length = np.linalg.norm(eps)
    log_R_e = 2.0 * np.arctan2(length, eta) * np.array(eps) / length if length > 0.0 else np.zeros(3)

    e_x = np.concatenate([R.T @ (q_d[:3] - q[:3]), log_R_e, q_d[7:] - q[7:]])
    e_v = np.concatenate([R_e @ linear_d - linear, R_e @ omega_d - omega, v_d[6:] - v[6:]])
    feedforward = np.concatenate(
        [
            R_e @ (a_d[:3] + np.cross(omega_d, linear_d)) - np.cross(omega, linear),
            R_e @ a_d[3:6] - np.cross(omega, R_e @ omega_d),
            a_d[6:],
        ]
    )
    return e_x, e_v, feedforward


def mass_and_bias(model: Any, q: Vector, v: Vector) -> tuple[Vector, Vector]:
    """Return the symmetric M (6+n, 6+n) and c = C v (6+n,) of M a + c = u; u is dual to v."""
    data = model.createData()
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T, pin.nonLinearEffects(model, data, q, v)


def computed_torque(
    model: Any,
    q: Vector,
    v: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    *,
    omega_n: Vector,
    zeta: float,
    free_floating: bool = False,
) -> Vector:
    """Return u = M0 a + c0 (6+n,) with a = feed-forward + K_d e_v + K_p e_x.

    Args:
        model: the nominal ``pin.Model``, free-flyer root, no gravity.
        q: (7+n,) configuration.
        v: (6+n,) velocity.
        q_d: (7+n,) desired.
        v_d: (6+n,) desired.
        a_d: (6+n,) desired.
        omega_n: (6+n,) natural frequencies [rad/s].
        zeta: damping ratio.
        free_floating: no force acts on the base; its translation follows from the zero-force rows.
    """
    e_x, e_v, feedforward = errors(q, v, q_d, v_d, a_d)
    K_p, K_d = np.diag(omega_n**2), np.diag(2.0 * zeta * omega_n)
    a = feedforward + K_d @ e_v + K_p @ e_x

    M, c = mass_and_bias(model, q, v)
    if free_floating:
        a[:3] = -np.linalg.solve(M[:3, :3], M[:3, 3:] @ a[3:] + c[:3])
    u: Vector = M @ a + c
    if free_floating:
        u[:3] = 0.0
    return u
