"""The data flow on one screen: the values on the arrows and the four protocols between them.

    reference(t) ----.
                     v
    state --> Controller.update(state, reference) --> ControlOutput(command, telemetry)
      ^                                                   |
      '---- Plant.step(command) <-------------------------'          every value of a tick --> Sink

Conventions: SI units; time is integer nanoseconds since the start of the run; quaternions are (x, y, z, w), unit, body
to inertial. With n joints a configuration is ``q = [position(3) inertial, quaternion(4), joints(n)]`` and a velocity is
``v = [linear(3), angular(3), joint rates(n)]`` with the base part in the BODY frame (Pinocchio's free-flyer, and the
twist of nav_msgs/Odometry). Accelerations are the time derivatives of the components of v.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.values import NANOSECONDS as NANOSECONDS
from space_robot_msgs_py.values import Acknowledgement as Acknowledgement
from space_robot_msgs_py.values import Command as Command
from space_robot_msgs_py.values import ControlOutput as ControlOutput
from space_robot_msgs_py.values import PlantSample as PlantSample
from space_robot_msgs_py.values import Reference as Reference
from space_robot_msgs_py.values import RobotState as RobotState
from space_robot_msgs_py.values import Supervision as Supervision
from space_robot_msgs_py.values import Telemetry as Telemetry
from space_robot_msgs_py.values import Tick as Tick
from space_robot_msgs_py.vectors import Vector as Vector


class Controller(Protocol):
    """Decides: a control law with its nominal model and gains."""

    def reset(self) -> None:
        """Forget the past; the next update is the first of a run."""

    def update(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Answer one state. Raises ControlError where the law cannot go on."""


class SupervisedController(Controller, Protocol):
    """A controller whose law and reference depend on a mode."""

    def check_decision(self, decision: Supervision) -> None:
        """Raise SpecError for a mode, a law or a reference that this controller does not have."""

    def supervise(self, decision: Supervision) -> None:
        """Take note of what holds from the state on that comes next."""


class SupervisorUnit(Protocol):
    """Watches: looks at every state before the controller answers it, and decides on the mode."""

    def reset(self) -> None:
        """Forget the past; the next update is the first of a run."""

    def order(self, command: str) -> Acknowledgement:
        """Take a command of the ground, which acts at the next update."""

    def update(
        self,
        state: RobotState,
        reference: Reference,
        answer: ControlOutput | None = None,
        events: Sequence[DiagnosticEvent] = (),
    ) -> Supervision:
        """Look at one state, its reference, the newest answer to one before and what the plant's monitor reports."""


class Plant(Protocol):
    """Happens: the true robot with its actuators and sensors."""

    def reset(self) -> PlantSample:
        """Return to the initial state and show it (stamp 0)."""

    def step(self, command: Command | None) -> PlantSample:
        """Advance one control period under the command (None: the defined hold) and show the state at its end."""


@runtime_checkable
class SupervisedPlant(Protocol):
    """A plant on which the mode of a supervisor acts beside the controller."""

    def close_brakes(self, closed: bool) -> None:
        """Close the brakes of all joints, or open them, from the next step on."""

    def unload_wheels(self, on: bool) -> None:
        """Let thrusters unload the wheels, or not, from the next step on."""


class ReferenceSource(Protocol):
    """Asks: the desired motion as a function of time."""

    def at(self, stamp: int) -> Reference:
        """The reference at a stamp [ns]."""


class Sink(Protocol):
    """Takes ticks in order; a log, or memory."""

    def record(self, tick: Tick) -> None:
        """Take one complete tick."""

    def record_unanswered(
        self, sample: PlantSample, reference: Reference, supervision: Supervision | None = None
    ) -> None:
        """Take the last state of a run whose controller had no answer to it."""

    def close(self, reason: str) -> None:
        """No more ticks; say why (``completed``, ``interrupted``, or the error)."""
