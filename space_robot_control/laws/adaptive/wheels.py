"""Momentum of the reaction wheels, dead-reckoned from the commands."""

from __future__ import annotations

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector


class WheelMomentum:
    """Momentum h of the nominal wheels in the body frame, dead-reckoned from the commanded torque: h' = -torque.

    On a base that turns with omega the torque -omega x h acts beside the commanded one. No topic carries wheel speeds,
    so h is the integral of the applied commands, of what the wheels can give of them: each within its torque, and none
    beyond its momentum. Friction of the wheels is not in it. Robots without wheels have h = 0.

    Args:
        robot: the NOMINAL robot.
        known: false: the law neglects the wheels' momentum, h = 0.

    Attributes:
        momentum: (3,) h at the present stamp [N m s].
    """

    def __init__(self, robot: Robot, *, known: bool = True) -> None:
        wheels = robot.actuators.base_torque
        self.momentum: Vector = np.zeros(3)
        self._stored = np.zeros(0)
        if not (known and isinstance(wheels, ReactionWheels)):
            return
        self._limits, self._capacity, self._torque = CommandLimits(robot), wheels.momentum, wheels.torque
        self._preserve = robot.actuators.saturation == "direction_preserving"
        axes = np.array(wheels.axes)
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        self._axes, self._share = axes, np.linalg.pinv(axes.T)
        self._stored = np.zeros(len(axes))
        if wheels.initial_momentum is not None:
            self._stored = np.array(wheels.initial_momentum)
            self.momentum = self._stored @ axes

    def apply(self, u: Vector, seconds: float) -> Vector:
        """Integrate the command u (6+n,) [N, N m] that acts over a time [s]; returns h (3,) in the middle of it."""
        if not self._stored.size:
            return self.momentum
        fits = self._limits.fits(u)
        rates = -self._share @ u[3:6]
        if not fits:
            scale = self._limits.common_scale(u) if self._preserve else 1.0
            rates = np.clip(scale * rates, -self._torque, self._torque)
        filled, half = self._stored + seconds * rates, 0.5 * seconds
        full = np.abs(filled) > self._capacity
        if fits and not full.any():
            # The same sum without the detour over the wheels: its rounding is part of every log.
            middle: Vector = self.momentum - half * u[3:6]
            self._stored, self.momentum = filled, middle - half * u[3:6]
            return middle
        middle = self._within(self._stored + half * rates) @ self._axes
        self._stored = self._within(filled)
        self.momentum = self._stored @ self._axes
        return middle

    def _within(self, stored: Vector) -> Vector:
        return np.clip(stored, -self._capacity, self._capacity)
