"""The linear separation on one screen: M, C and Y of a free-flying robot in Euler coordinates, with explicit matrices.

x = [position inertial, yaw, pitch, roll, joints], R = Rz Ry Rx; pi has ten parameters [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz,
Izz] about the joint origin, body after body, base first. Body twists are [linear, angular] of the joint origin, in the
joint frame; arguments q, v, a are Pinocchio's free-flyer.

Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (29), appendix A; for C Echeandia and Wensing, J. Computational and
Nonlinear Dynamics 16(9), 2021.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_control.laws.ntsmc.reference_euler import N as N_of
from space_robot_control.laws.ntsmc.reference_euler import N_dot, N_inverse, wrap
from space_robot_msgs_py.interfaces import Vector

SWAP = np.eye(3)[::-1]  # yaw, pitch, roll from roll, pitch, yaw, and back


def euler(q: Vector, v: Vector, a: Vector) -> tuple[Vector, Vector, Vector]:
    """Return x, x', x'' (6+n,)."""
    R, omega = pin.Quaternion(q[3:7]).matrix(), v[3:6]
    theta = pin.rpy.matrixToRpy(R)
    rate = N_inverse(theta, 0.0) @ omega
    acceleration = N_inverse(theta, 0.0) @ (a[3:6] - N_dot(theta, rate) @ rate)
    return (
        np.concatenate([q[:3], SWAP @ theta, q[7:]]),
        np.concatenate([R @ v[:3], SWAP @ rate, v[6:]]),
        np.concatenate([R @ (a[:3] + np.cross(omega, v[:3])), SWAP @ acceleration, a[6:]]),
    )


def short_way(difference: Vector) -> Vector:
    """A difference of coordinates with yaw and roll within half a turn."""
    out = np.array(difference)
    out[[3, 5]] = wrap(out[[3, 5]])
    return out


def spatial_inertia(pi: Vector) -> Vector:
    """I (6, 6) of the ten parameters of a body, linear in them."""
    m, S_h, (xx, xy, yy, xz, yz, zz) = pi[0], pin.skew(pi[1:4]), pi[4:]
    return np.block([[m * np.eye(3), -S_h], [S_h, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])]])


def cross_motion(V: Vector) -> Vector:
    """V x (6, 6), the derivative of a twist in a body that moves with V; V x* = -(V x)^T for wrenches."""
    S_v, S_w = pin.skew(V[:3]), pin.skew(V[3:])
    return np.block([[S_w, S_v], [np.zeros((3, 3)), S_w]])


def cross_wrench(F: Vector) -> Vector:
    """The (6, 6) matrix of V -> V x* F."""
    S_f, S_n = pin.skew(F[:3]), pin.skew(F[3:])
    return -np.block([[np.zeros((3, 3)), S_f], [S_f, S_n]])


class Dynamics:
    """M, C and Y at x and x', and G with v = G x', so that tau = G^T u.

    A body with twist V = J x' needs the wrench I V' + V x* I V. As M x'' + C x' with M' - 2 C skew that is

        M = sum J^T I J,    C = sum J^T (I J' + B J),    B = (V x* I + (I V) x* + I V x) / 2.
    """

    def __init__(self, model: Any, x: Vector, dx: Vector) -> None:
        theta, rate = SWAP @ x[3:6], SWAP @ dx[3:6]
        R, N = pin.rpy.rpyToMatrix(theta), N_of(theta)
        self.dx, self.G, G_dot = dx, np.eye(x.size), np.zeros((x.size, x.size))
        self.G[:3, :3], self.G[3:6, 3:6] = R.T, N @ SWAP
        G_dot[:3, :3], G_dot[3:6, 3:6] = -pin.skew(N @ rate) @ R.T, N_dot(theta, rate) @ SWAP
        q, data = np.concatenate([x[:3], pin.Quaternion(R).coeffs(), x[6:]]), model.createData()
        pin.computeJointJacobiansTimeVariation(model, data, q, self.G @ dx)
        M, C = [], []
        for i in range(1, model.njoints):
            J_v = pin.getJointJacobian(model, data, i, pin.LOCAL)
            J = J_v @ self.G
            J_dot = pin.getJointJacobianTimeVariation(model, data, i, pin.LOCAL) @ self.G + J_v @ G_dot
            V = J @ dx
            for unit in np.eye(10):
                inertia = spatial_inertia(unit)
                B = -cross_motion(V).T @ inertia + cross_wrench(inertia @ V) + inertia @ cross_motion(V)
                M.append(J.T @ inertia @ J)
                C.append(J.T @ (inertia @ J_dot + 0.5 * B @ J))
        self.M_k, self.C_k = np.array(M), np.array(C)  # (10 (1+n), 6+n, 6+n), one per unit parameter

    def M(self, pi: Vector) -> Vector:
        """Return the (6+n, 6+n) mass matrix M of x."""
        M: Vector = np.einsum("k,kij->ij", pi, self.M_k)
        return M

    def C(self, pi: Vector) -> Vector:
        """Return Christoffel's (6+n, 6+n) C of x, x'."""
        C: Vector = np.einsum("k,kij->ij", pi, self.C_k)
        return C

    def Y(self, dx_r: Vector, ddx_r: Vector) -> Vector:
        """Return the (6+n, 10 (1+n)) Y of x, x', x_r', x_r'': Y pi = M x_r'' + C x_r', (29)."""
        return (self.M_k @ ddx_r + self.C_k @ dx_r).T

    def mass(self, pi: Vector) -> float:
        """The mass of all bodies."""
        return float(pi[::10].sum())
