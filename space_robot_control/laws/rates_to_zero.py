"""What laws have in common that bring a robot to rest and follow no reference."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.command_limits import CommandLimits
from space_robot_control.kernel.rest import RestRobot, rest_room
from space_robot_control.laws.base import Blocks, Law
from space_robot_control.laws.compiled import Answering, CompiledLaw
from space_robot_control.nominal_friction import NominalFriction
from space_robot_control.nominal_model import NominalModel
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class RatesToZero(Law):
    """A law with one rate of decay, on the degrees of freedom that have an actuator; subclasses give its kernel.

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
        # The rates it desires are not the reference's.
        self.friction = NominalFriction(robot, known=False)
        model, floating = NominalModel(robot), robot.base_mode == "free_floating"
        self.known = RestRobot(model.arrays, CommandLimits(robot).numbers, model.mass, int(floating))
        self.room, self.actuated = rest_room(robot.n, len(robot.mimics)), 3 + robot.n if floating else 6 + robot.n
        self.errors = dict(
            position_error=3, attitude_error=3, joint_error=self.n, twist_error=6, joint_rate_error=self.n
        )
        self.begun = np.zeros(1, dtype=np.int64)
        self.retune(self.gains)
        self._form = self.form()
        self._answer = Answering(self._form.answer, self.n, self._form.layout)

    def reset(self) -> None:
        """Forget what the first state or the path was."""
        super().reset()
        self.begun[0] = 0

    @abstractmethod
    def form(self) -> CompiledLaw:
        """The kernel of this law and the memory that it works on; called once."""

    def retune(self, gains: Gains) -> None:
        """Go on with another rate."""
        self.room.rate[0] = gains.rate

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw:
        """The law for compiled runs."""
        return self._form

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the nominal inertia is not finite, or where its inverse is taken not positive definite.
        """
        status, u, row = self._answer(self._form.context, state, reference, self.wheels.momentum)
        if status:
            raise ControlError("the nominal inertia is not usable", key="H", value=state.q.tolist())
        return u, self._form.layout.blocks(row)
