"""What laws have in common that bring a robot to rest and follow no reference."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from space_robot_control.laws.base import Law
from space_robot_control.nominal_friction import NominalFriction
from space_robot_control.nominal_model import NominalModel
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot


class RatesToZero(Law):
    """A law with one rate of decay, on the degrees of freedom that have an actuator.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: rate.
    """

    class Gains(Law.Gains):
        """Gains of a law that brings a robot to rest."""

        rate: PositiveFloat = Field(
            default=0.5, description="w, how fast rates decay in continuous time [1/s]", json_schema_extra=DYNAMIC
        )

    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self._model = NominalModel(robot)
        # The rates it desires are not the reference's.
        self.friction = NominalFriction(robot, known=False)
        self._first = 3 if robot.base_mode == "free_floating" else 0
