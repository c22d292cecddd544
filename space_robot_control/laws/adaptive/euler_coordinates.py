"""Euler coordinates of a free-flying robot: where its equations are linear in the inertial parameters.

x = [position(3) inertial, yaw, pitch, roll, joints(n)], R = Rz(yaw) Ry(pitch) Rx(roll), and x' its plain derivative.
The order is that of the rotations, Phi = [alpha, beta, gamma] of Liu, Teng, Jin (2023), sec. 2.2.2. Singular where
cos(pitch) = 0 (the paper says cos(alpha)).
"""

from __future__ import annotations

import numpy as np

from space_robot_control.laws.adaptive.kernel.euler import PITCH, ROLL, YAW, coordinates
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

__all__ = ["PITCH", "ROLL", "YAW", "euler_state"]


def euler_state(state: RobotState | Reference) -> tuple[Vector, Vector]:
    """Return x (6+n,) [m, rad] and x' (6+n,) [m/s, rad/s] of a state or a reference."""
    x, dx = np.empty(state.v.size), np.empty(state.v.size)
    coordinates(state.q, state.v, x, dx)
    return x, dx
