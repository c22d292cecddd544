"""The law of zero command: for free motion, and as the smallest complete example of a law."""

from __future__ import annotations

import numpy as np

from space_robot_control.laws.base import Blocks, Law
from space_robot_control.nominal_friction import NominalFriction
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class ZeroCommand(Law):
    """u = 0, whatever the state."""

    name = "none"
    telemetry_fields = ERROR_FIELDS

    def __init__(self, robot: Robot, control_period: float, gains: Law.Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        # Zero is zero, whatever is known of friction.
        self.friction = NominalFriction(robot, known=False)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return zero force, torque and efforts, and the tracking errors."""
        return np.zeros(6 + self.n), error_blocks(tracking_errors(state, reference))
