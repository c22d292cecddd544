"""Euler coordinates in scalar code: from quaternions and twists, and torques to and fro.

x = [position(3) inertial, yaw, pitch, roll, joints(n)], R = Rz(yaw) Ry(pitch) Rx(roll), and x' its plain derivative.
Three angles are (roll, pitch, yaw), as in ``rotations``.
"""

from __future__ import annotations

from math import pi, sqrt, tau

from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix
from space_robot_description.kernel.spatial import Vec, add, cross, mul
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2, sincos

YAW, PITCH, ROLL = 3, 4, 5


def rates(rpy: Vec, omega: Vec) -> Vec:
    """Return the rates of roll, pitch, yaw under a body angular velocity: the inverse of ``rotations.rpy_rates``.

    Args:
        rpy: roll, pitch, yaw [rad], cos(pitch) not zero.
        omega: (3,) body frame [rad/s].
    """
    roll, pitch, _ = rpy
    wx, wy, wz = omega
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    dyaw = (sr * wy + cr * wz) / cp
    return wx + sp * dyaw, cr * wy - sr * wz, dyaw


def accelerations(rpy: Vec, drpy: Vec, omega: Vec, alpha: Vec) -> Vec:
    """Return the second derivatives of roll, pitch, yaw under a body angular acceleration.

    Args:
        rpy: roll, pitch, yaw [rad], cos(pitch) not zero.
        drpy: their rates [rad/s].
        omega: (3,) body frame [rad/s].
        alpha: (3,) derivative of the components of omega [rad/s2].
    """
    roll, pitch, _ = rpy
    droll, dpitch, dyaw = drpy
    _, wy, wz = omega
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    ay, az = alpha[1] - droll * wz, alpha[2] + droll * wy
    ddyaw = (sr * ay + cr * az + dyaw * dpitch * sp) / cp
    return alpha[0] + ddyaw * sp + dyaw * dpitch * cp, cr * ay - sr * az, ddyaw


def body_torque(rpy: Vec, about: Vec) -> Vec:
    """Return the torque in the body frame of generalised torques: N^-T tau_Phi [N m].

    Args:
        rpy: roll, pitch, yaw [rad], cos(pitch) not zero.
        about: (3,) forces dual to the rates of roll, pitch, yaw [N m].
    """
    roll, pitch, _ = rpy
    about_roll, about_pitch, about_yaw = about
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    b = (about_yaw + sp * about_roll) / cp
    return about_roll, cr * about_pitch + sr * b, cr * b - sr * about_pitch


def generalised_torque(rpy: Vec, torque: Vec) -> Vec:
    """Return the forces dual to the rates of roll, pitch, yaw of a torque in the body frame: the inverse [N m]."""
    roll, pitch, _ = rpy
    tx, ty, tz = torque
    (sr, cr), (sp, cp) = sincos(roll), sincos(pitch)
    return tx, cr * ty - sr * tz, cp * (sr * ty + cr * tz) - sp * tx


def short_way(angle: float) -> float:
    """Return the angle within half a turn of zero that differs from this one by whole turns [rad]."""
    return angle - tau * round(angle / tau)


rates_in = inner(rates)
accelerations_in = inner(accelerations)
body_torque_in = inner(body_torque)
generalised_torque_in = inner(generalised_torque)
short_way_in = inner(short_way)


@inner
def angles(x: Vector) -> Vec:
    """Roll, pitch, yaw of x."""
    return x[ROLL], x[PITCH], x[YAW]


@kernel
def coordinates(q: Vector, v: Vector, x: Vector, dx: Vector) -> None:
    """Write x (6+n,) [m, rad] and x' [m/s, rad/s] of a configuration q (7+n,) and a velocity v (6+n,).

    The angles as in ``rotations.to_rpy``, which says why.
    """
    a, b, c, d = q[3], q[4], q[5], q[6]
    difference, total = atan2(a - c, d + b), atan2(a + c, d - b)
    across, along = sqrt((d + b) * (d + b) + (a - c) * (a - c)), sqrt((d - b) * (d - b) + (a + c) * (a + c))
    rpy = (
        short_way_in(total + difference),
        2.0 * atan2(across, along) - 0.5 * pi,
        short_way_in(total - difference),
    )
    droll, dpitch, dyaw = rates_in(rpy, (v[3], v[4], v[5]))
    velocity = mul(matrix((a, b, c, d)), (v[0], v[1], v[2]))
    for i in range(3):
        x[i], dx[i] = q[i], velocity[i]
    x[ROLL], x[PITCH], x[YAW] = rpy
    dx[ROLL], dx[PITCH], dx[YAW] = droll, dpitch, dyaw
    for i in range(6, x.shape[0]):
        x[i], dx[i] = q[i + 1], v[i]


@kernel
def second_derivative(q: Vector, v: Vector, a: Vector, x: Vector, dx: Vector, ddx: Vector) -> None:
    """Write x'' (6+n,) [m/s2, rad/s2] of q, v, a = dv/dt whose x and x' are known."""
    omega, velocity = (v[3], v[4], v[5]), (v[0], v[1], v[2])
    turn = matrix(attitude(q))
    linear = mul(turn, add((a[0], a[1], a[2]), cross(omega, velocity)))
    bend = accelerations_in(angles(x), angles(dx), omega, (a[3], a[4], a[5]))
    for i in range(3):
        ddx[i] = linear[i]
    ddx[ROLL], ddx[PITCH], ddx[YAW] = bend
    for i in range(6, ddx.shape[0]):
        ddx[i] = a[i]
