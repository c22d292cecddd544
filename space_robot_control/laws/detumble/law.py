"""Detumble: every rate to zero at one speed, while the arm keeps the shape it has at the first state."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.base import Blocks
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class Detumble(RatesToZero):
    """u = -s H (w' v + w'^2 / 4 [0, q - q0]), w' = w / (1 + w T): rates to zero, the arm stays where it was.

    H is the nominal inertia at the state, with the translation eliminated where no force acts on the base; q0 are the
    joints at the first state after a reset; s in (0, 1] scales the command until it fits the actuators. Base and joints
    do not disturb each other to first order in the rates. The reference is not followed; errors to it are telemetry.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: rate.

    The equations on one screen: ``reference.py``.

    Deviations from the paper: there is none; this is the law a robot falls back to.
    """

    name = "detumble"
    gain_ranges: ClassVar[GainRanges] = {"rate": GainRange(0.02, 5.0)}
    telemetry_fields = ERROR_FIELDS | {
        "joint_offset": "q - q0 [rad or m]",
        "scale": "s, less than 1 where the actuators cannot give the command [-]",
    }

    def __init__(self, robot: Robot, control_period: float, gains: RatesToZero.Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self._limits = CommandLimits(robot)
        self._shape: Vector | None = None

    def reset(self) -> None:
        """Forget the shape of the arm."""
        super().reset()
        self._shape = None

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        if self._shape is None:
            self._shape = state.joints
        offset, inertia = state.joints - self._shape, self._model.actuated_mass_matrix(state.q)
        decay = self.gains.rate / (1.0 + self.gains.rate * self.control_period)
        acceleration = -decay * state.v[self._first :]
        acceleration[-self.n :] -= 0.25 * decay**2 * offset
        u = np.zeros(6 + self.n)
        u[self._first :] = inertia @ acceleration
        scale = self._limits.common_scale(u)
        errors = error_blocks(tracking_errors(state, reference))
        return scale * u, {**errors, "joint_offset": offset, "scale": scale}
