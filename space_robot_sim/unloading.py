"""Unloading: thrusters take out the momentum that reaction wheels hold, while the base feels nothing of it."""

from __future__ import annotations

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times
from space_robot_sim.kernel.allocation import Capability


class Unloading:
    """What thrusters and wheels do in a period in which the wheels are unloaded.

    The thrusters give the torque tau = -h / T on the base, within their limit, where the wheels hold h at the beginning
    of the period T. Wheel i takes up s_i tau beside its share of the command, with the rows s_i of the pseudo-inverse
    of the axes, which is -tau on the base. So the base gets what the command asks for, and h goes to zero. As much of
    tau is given as every wheel has torque left for beside the command.

    Args:
        robot: the true one, with reaction wheels that have ``unloading``.
        period: control period T [s].
    """

    def __init__(self, robot: Robot, period: float) -> None:
        wheels = robot.actuators.base_torque
        assert isinstance(wheels, ReactionWheels)
        assert wheels.unloading is not None
        self._limit, self._period = np.array(wheels.unloading), period

    def able(self, able: Capability, command: Vector, wheels: Vector, on: bool) -> tuple[Capability, list[float]]:
        """What the actuators can do in a period, and the block ``unloading`` of the telemetry, see PlantTelemetry.

        Args:
            able: what they can do otherwise.
            command: (6+n,) that acts [N, N m].
            wheels: (k,) momenta at the beginning of the period [N m s].
            on: wheels are unloaded.
        """
        if not on:
            return able, [0.0] * 4
        torque = np.clip(-times(able.axes, wheels) / self._period, -self._limit, self._limit)
        part = times(able.share, torque)
        most = able.wheel_limit[:, 0]
        own = np.clip(-times(able.share, command[3:6]), -most, most)
        # What a wheel has left in the direction of its part.
        room = np.divide(most - np.sign(part) * own, np.abs(part), out=np.full(part.size, np.inf), where=part != 0.0)
        scale = min(1.0, max(0.0, float(room.min())))
        push, outside = able.push + scale * part, able.outside.copy()
        outside[3:] += scale * torque
        now = able._replace(disturbed=1, push=push, outside=outside)
        return now, [1.0, *(scale * torque).tolist()]
