"""Torque around wheels that failed: what the wheels that are left are to be asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_description.kernel.linear import inverse
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.kernel.products import times

# Of the unit axes that are left, the smallest singular value with which they still span space.
MIN_SPAN = 1e-3


class Reallocation:
    """Commands by which the wheels that are left give the torque that all of them would.

    Actuators share a torque tau among all wheels: wheel i gives s_i tau, with the rows s_i of the pseudo-inverse of the
    unit axes a_i. Where the wheels of a set F give nothing the base gets E tau, E = I - sum_F a_i s_i. The command
    E^-1 tau gets it tau again; of four wheels without one it is the only one that does. Beyond the torque of a wheel it
    is clipped like any command.

    Args:
        robot: the NOMINAL robot.
        off: indices of the wheels that failed, from 0.
        key: for errors.

    Raises:
        SpecError: there is no such wheel, or those that are left do not span space.
    """

    def __init__(self, robot: Robot, off: Sequence[int], key: str) -> None:
        limits = CommandLimits(robot)
        axes, share, count = limits.axes, limits.share, limits.share.shape[0]
        for wheel in off:
            if not 0 <= wheel < count or not isinstance(robot.actuators.base_torque, ReactionWheels):
                accepted = f"0 to {count - 1}" if count else "a robot with reaction wheels"
                raise SpecError("no such wheel", key=key, value=wheel, accepted=accepted)
        left = [wheel for wheel in range(count) if wheel not in off]
        if len(left) < 3 or np.linalg.svd(axes[:, left], compute_uv=False)[2] < MIN_SPAN:
            accepted = "as many as leave wheels about three axes"
            raise SpecError("the wheels that are left do not span space", key=key, value=list(off), accepted=accepted)
        self._rows: list[list[float]] = inverse(times(axes[:, left], share[left])).tolist()

    def command(self, command: Command) -> Command:
        """The command that gives what this one would with all wheels."""
        fx, fy, fz, x, y, z = command.wrench.tolist()
        torque = [a * x + b * y + c * z for a, b, c in self._rows]
        return Command(command.stamp, np.array([fx, fy, fz, *torque]), command.effort)
