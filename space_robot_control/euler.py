"""Euler coordinates of a free-flying robot: where its equations are linear in the inertial parameters.

x = [position(3) inertial, yaw, pitch, roll, joints(n)], R = Rz(yaw) Ry(pitch) Rx(roll), and x' its plain derivative.
The order is that of the rotations, Phi = [alpha, beta, gamma] of Liu, Teng, Jin (2023), sec. 2.2.2. Singular where
cos(pitch) = 0 (the paper says cos(alpha)).

Like ``rotations`` on Python floats: at these sizes several times faster than on arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, cos, remainder, sin, tau

import numpy as np

from space_robot_control.rotations import Three, cross, rotate, to_rpy
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

YAW, PITCH, ROLL = 3, 4, 5


def euler_state(state: RobotState | Reference) -> tuple[Vector, Vector]:
    """Return x (6+n,) [m, rad] and x' (6+n,) [m/s, rad/s] of a state or a reference."""
    q, v = state.q.tolist(), state.v.tolist()
    rpy = to_rpy(q[3:7])
    droll, dpitch, dyaw = rates(rpy, v[3:6])
    x = (*q[:3], rpy[2], rpy[1], rpy[0], *q[7:])
    return np.array(x), np.array((*rotate(q[3:7], v[:3]), dyaw, dpitch, droll, *v[6:]))


def euler_acceleration(reference: Reference, x: Vector, dx: Vector) -> Vector:
    """Return x'' (6+n,) of a reference whose x and x' are known [m/s2, rad/s2]."""
    v, a = reference.v.tolist(), reference.a.tolist()
    yaw, pitch, roll = x[YAW : ROLL + 1].tolist()
    dyaw, dpitch, droll = dx[YAW : ROLL + 1].tolist()
    linear = [one + other for one, other in zip(a[:3], cross(v[3:6], v[:3]), strict=True)]
    bend = accelerations((roll, pitch, yaw), (droll, dpitch, dyaw), v[3:6], a[3:6])
    return np.array((*rotate(reference.q[3:7], linear), bend[2], bend[1], bend[0], *a[6:]))


def rates(rpy: Sequence[float], omega: Sequence[float], smallest_cosine: float = 0.0) -> Three:
    """Return the rates of roll, pitch, yaw under a body angular velocity: the inverse of ``rotations.rpy_rates``.

    Args:
        rpy: roll, pitch, yaw [rad], cos(pitch) not zero.
        omega: (3,) body frame [rad/s].
        smallest_cosine: what |cos(pitch)| counts as where it is less.
    """
    (roll, pitch, _), (wx, wy, wz) = rpy, omega
    cr, sr, cp = cos(roll), sin(roll), cos(pitch)
    if abs(cp) < smallest_cosine:
        cp = copysign(smallest_cosine, cp)
    dyaw = (sr * wy + cr * wz) / cp
    return wx + sin(pitch) * dyaw, cr * wy - sr * wz, dyaw


def accelerations(rpy: Sequence[float], drpy: Sequence[float], omega: Sequence[float], alpha: Sequence[float]) -> Three:
    """Return the second derivatives of roll, pitch, yaw under a body angular acceleration.

    Args:
        rpy: roll, pitch, yaw [rad], cos(pitch) not zero.
        drpy: their rates [rad/s].
        omega: (3,) body frame [rad/s].
        alpha: (3,) derivative of the components of omega [rad/s2].
    """
    (roll, pitch, _), (droll, dpitch, dyaw), (_, wy, wz) = rpy, drpy, omega
    cr, sr, cp, sp = cos(roll), sin(roll), cos(pitch), sin(pitch)
    ay, az = alpha[1] - droll * wz, alpha[2] + droll * wy
    ddyaw = (sr * ay + cr * az + dyaw * dpitch * sp) / cp
    return alpha[0] + ddyaw * sp + dyaw * dpitch * cp, cr * ay - sr * az, ddyaw


def body_torque(x: Vector, generalised: Sequence[float]) -> Three:
    """Return the torque in the body frame of the generalised torques about yaw, pitch, roll: N^-T tau_Phi [N m].

    Args:
        x: (6+n,) Euler coordinates.
        generalised: (3,) forces dual to the rates of yaw, pitch, roll [N m].
    """
    _, pitch, roll = x[YAW : ROLL + 1].tolist()
    about_yaw, about_pitch, about_roll = generalised
    cr, sr = cos(roll), sin(roll)
    b = (about_yaw + sin(pitch) * about_roll) / cos(pitch)
    return about_roll, cr * about_pitch + sr * b, cr * b - sr * about_pitch


def generalised_torque(x: Vector, torque: Sequence[float]) -> Three:
    """Return the generalised torques about yaw, pitch, roll of a torque in the body frame: the inverse [N m]."""
    _, pitch, roll = x[YAW : ROLL + 1].tolist()
    tx, ty, tz = torque
    cr, sr, cp, sp = cos(roll), sin(roll), cos(pitch), sin(pitch)
    return cp * (sr * ty + cr * tz) - sp * tx, cr * ty - sr * tz, tx


def difference(to: Vector, start: Vector) -> Vector:
    """Return to - start (6+n,) in Euler coordinates, yaw and roll the short way round."""
    out = to - start
    out[YAW], out[ROLL] = remainder(out[YAW], tau), remainder(out[ROLL], tau)
    return out
