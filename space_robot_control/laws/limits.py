"""What the nominal base actuators can give: whether a commanded wrench is also the applied one."""

from __future__ import annotations

import numpy as np

from space_robot_control.kernel.lesson import fits
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector


class BaseLimits:
    """Limits of force and torque on the base; wheels share a torque by the pseudo-inverse of their axes.

    Args:
        robot: the NOMINAL robot.
    """

    def __init__(self, robot: Robot) -> None:
        torque, force = robot.actuators.base_torque, robot.actuators.base_force
        self._force = np.zeros(3) if force is None else np.array(force.limit)
        if isinstance(torque, ReactionWheels):
            axes = np.array(torque.axes).T
            self._share = np.ascontiguousarray(np.linalg.pinv(axes / np.linalg.norm(axes, axis=0)))
            self._torque = np.full(self._share.shape[0], torque.torque)
        else:
            self._share, self._torque = np.identity(3), np.array(torque.limit)

    def fits(self, wrench: Vector) -> bool:
        """True if force and torque (6,) are within the limits [N, N m]."""
        return fits(self._share, self._torque, self._force, wrench)
