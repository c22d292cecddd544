"""The Euler-angle baseline of Giordano and Cenedese on one screen, reconstructed: the attitude for ``reference.Ntsmc``.

x' of the base rotation is theta', theta = roll, pitch, yaw, R = Rz Ry Rx, w_body = N theta'. A rotation has the
triplets (r, p, y) and (r + pi, pi - p, y + pi), each angle up to whole turns; the one nearest to the last is taken. Not
here: the choice of roll and yaw at a pitch of exactly 90 deg.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from space_robot_control.laws.computed_torque.reference import attitude
from space_robot_control.laws.ntsmc.reference import Attitude
from space_robot_msgs_py.interfaces import Vector


def wrap(angle: Vector) -> Vector:
    """The angles within half a turn of zero."""
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))


def nearest(R: Vector, last: Vector) -> Vector:
    """The roll, pitch, yaw of R nearest to the last."""
    r, p, y = pin.rpy.matrixToRpy(R)
    triplets = [last + wrap(np.array(triplet) - last) for triplet in ((r, p, y), (r + np.pi, np.pi - p, y + np.pi))]
    return min(triplets, key=lambda theta: float(np.sum((theta - last) ** 2)))


def N(theta: Vector) -> Vector:
    """N (3, 3) of w_body = N theta'."""
    (cr, cp, _), (sr, sp, _) = np.cos(theta), np.sin(theta)
    return np.array([[1.0, 0.0, -sp], [0.0, cr, sr * cp], [0.0, -sr, cr * cp]])


def N_dot(theta: Vector, rate: Vector) -> Vector:
    """The derivative of N (3, 3)."""
    (cr, cp, _), (sr, sp, _), (dr, dp, _) = np.cos(theta), np.sin(theta), rate
    return np.array(
        [
            [0.0, 0.0, -cp * dp],
            [0.0, -sr * dr, cr * cp * dr - sr * sp * dp],
            [0.0, -cr * dr, -sr * cp * dr - cr * sp * dp],
        ]
    )


def N_inverse(theta: Vector, min_cosine: float) -> Vector:
    """N^-1 (3, 3) with |cos(pitch)| not below a minimum, which keeps it finite at 90 deg."""
    (cr, cp, _), (sr, sp, _) = np.cos(theta), np.sin(theta)
    cp = np.copysign(max(abs(cp), min_cosine), cp)
    return np.array([[1.0, sr * sp / cp, cr * sp / cp], [0.0, cr, -sr], [0.0, sr / cp, cr / cp]])


class EulerAngles:
    """e = theta - theta_d.

    Args:
        start: (3,) the first theta is the triplet nearest to this [rad].
        min_cosine: see ``N_inverse``.
        wrapped: e is taken within half a turn.
    """

    def __init__(self, start: Vector, min_cosine: float = 1e-3, *, wrapped: bool = False) -> None:
        self.theta, self.theta_d, self.min_cosine, self.wrapped = np.array(start), np.zeros(3), min_cosine, wrapped

    def __call__(self, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> Attitude:
        """Return the attitude, and remember the triplets."""
        self.theta, self.theta_d = nearest(attitude(q), self.theta), nearest(attitude(q_d), self.theta_d)
        theta, theta_d = self.theta, self.theta_d
        rate = N_inverse(theta, self.min_cosine) @ v[3:6]
        rate_d = N_inverse(theta_d, self.min_cosine) @ v_d[3:6]
        ddtheta_d = N_inverse(theta_d, self.min_cosine) @ (a_d[3:6] - N_dot(theta_d, rate_d) @ rate_d)
        e = wrap(theta - theta_d) if self.wrapped else theta - theta_d
        return Attitude(N(theta), N_dot(theta, rate), rate, e, rate - rate_d, rate - rate_d, ddtheta_d)
