"""Momentum of the reaction wheels, dead-reckoned from the commands."""

from __future__ import annotations

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector


class WheelMomentum:
    """Momentum h of the nominal wheels in the body frame, dead-reckoned from the commanded torque: h' = -torque.

    On a base that turns with omega the torque -omega x h acts beside the commanded one. No topic carries wheel speeds,
    so h is the integral of the applied commands; saturation and friction of the wheels are not in it. Robots without
    wheels have h = 0.

    Args:
        robot: the NOMINAL robot.
        known: false: the law neglects the wheels' momentum, h = 0.

    Attributes:
        momentum: (3,) h at the present stamp [N m s].
    """

    def __init__(self, robot: Robot, *, known: bool = True) -> None:
        wheels = robot.actuators.base_torque
        self._present = known and isinstance(wheels, ReactionWheels)
        self.momentum: Vector = np.zeros(3)
        if known and isinstance(wheels, ReactionWheels) and wheels.initial_momentum is not None:
            axes = np.array(wheels.axes)
            axes /= np.linalg.norm(axes, axis=1, keepdims=True)
            self.momentum = np.array(wheels.initial_momentum) @ axes

    def apply(self, torque: Vector, seconds: float) -> Vector:
        """Integrate a torque (3,) [N m] on the base over a time [s]; returns h (3,) in the middle of it."""
        if not self._present:
            return self.momentum
        half = 0.5 * seconds * torque
        middle: Vector = self.momentum - half
        self.momentum = middle - half
        return middle
