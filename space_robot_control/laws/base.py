"""What every control law is: a nominal robot, a control period, gains, and one equation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from space_robot_control.command_delay import CommandDelay
from space_robot_control.laws.compiled import CompiledLaw
from space_robot_control.laws.gain_range import GainRanges
from space_robot_control.laws.tunable import Tunable
from space_robot_control.nominal_friction import NominalFriction
from space_robot_control.tracking import prepare
from space_robot_control.wheel_momentum import WheelMomentum
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict
from space_robot_msgs_py.errors import CommandError, ControlError, NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import (
    NANOSECONDS,
    Command,
    ControlOutput,
    Reference,
    RobotState,
    Telemetry,
    Vector,
)

Blocks = Mapping[str, npt.ArrayLike]
UNIT_TOLERANCE = 1e-3  # a measured quaternion further from unit length is an error, not noise


@dataclass(frozen=True, slots=True)
class Review:
    """What a law finds about a run before it.

    Attributes:
        facts: lines for ``space-robot check``.
        warnings: what lies outside the law's own bounds; printed before every run, which goes on all the same.
    """

    facts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


class Inbox(Protocol):
    """What stands between the messages and a law in a run whose links have faults."""

    def hear(self, state: RobotState, reference: Reference) -> tuple[RobotState, Reference, bool]:
        """What has arrived at a tick, under its stamp, and whether the controller has just begun anew.

        A stamp that is not later than the last one begins a run.
        """


class Located(ControlError):
    """A ControlError that names the law and the time."""


class Law(Tunable, ABC):
    """A control law as a Controller: subclasses write ``compute`` and, if they remember anything, ``reset``.

    Subclasses with gains nest a ``Gains`` model and annotate ``gains: Gains``; every field has a default and a
    description with its unit. ``telemetry_fields`` describes the blocks of telemetry, with their units;
    ``uses_command_delay`` says that the law takes ``robot.command_delay`` into account; ``gain_ranges`` says which
    gains, by dotted name, ``space-robot tune`` may search and between which values. A law is a function of the states
    and references since the last ``reset``, of what ``tune`` changed between them, and of nothing else.

    Attributes:
        inbox: what stands between messages and law; None: nothing, as in every run without faults of links.
        wheels: momentum of the nominal wheels at the stamp of the state: measured, or dead-reckoned from the applied
            commands.
        friction: of the nominal joints, added to what ``compute`` returns where ``robot.knows_friction`` says so.

    Args:
        robot: the NOMINAL robot; a law never sees the true one.
        control_period: time between two updates [s].
        gains: an instance of this law's ``Gains``; None: the defaults.

    Raises:
        SpecError: the period is not positive or the gains are another law's.
    """

    class Gains(Strict):
        """The numbers to tune; this law has none."""

    name: ClassVar[str] = ""
    uses_command_delay: bool = False
    telemetry_fields: ClassVar[Mapping[str, str]] = {}
    gain_ranges: ClassVar[GainRanges] = {}
    gains: Gains
    inbox: Inbox | None = None

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__()
        if not (isfinite(control_period) and control_period > 0.0):
            raise SpecError(
                "not a period", key="control_period", value=control_period, accepted="a positive number [s]"
            )
        if gains is None:
            gains = self.Gains()
        if not isinstance(gains, self.Gains):
            raise SpecError(
                "not the gains of this law",
                key="controller.gains",
                value=type(gains).__qualname__,
                accepted=self.Gains.__qualname__,
            )
        self.robot = robot
        self.n = robot.n
        self.control_period = control_period
        self.gains = gains
        self._layout: tuple[tuple[str, ...], tuple[int, ...]] | None = None
        self._sent = CommandDelay(robot.command_delay, none=False)
        self.wheels = WheelMomentum(robot, known=robot.knows_wheels)
        self.friction = NominalFriction(robot, known=robot.knows_friction)
        prepare()

    @classmethod
    def must_compile(cls) -> bool:
        """True if making the next such law compiles it first, which takes seconds; by default never."""
        return False

    @abstractmethod
    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return the generalised force u (6+n,) [N, N m] and the labelled blocks of telemetry.

        Args:
            state: the measured state; sizes and quaternion are checked.
            reference: the reference of the same stamp.

        Returns:
            u = [force(3), torque(3), efforts(n)], base part in the body frame; and blocks of constant labels and sizes.
        """

    def compiled(self) -> CompiledLaw | None:
        """This law for runs that call no Python between their ticks, see ``kernel/answers.py``; None: it cannot be.

        Its functions give what ``compute`` and ``on_applied`` give, and change the same memory.
        """
        return None

    def prepare(self) -> None:
        """Load or compile what ``compute`` calls; a node does it first, for its first answer is due within a period."""

    def review(self, path: Sequence[Reference]) -> Review:
        """Judge these gains at this period for this robot along a path, before the run; by default nothing is found.

        Args:
            path: where the robot starts, then references over the whole run.
        """
        del path
        return Review()

    def reset(self) -> None:
        """Forget the past, but not what was tuned; the next update is the first of a run.

        Overriding laws call this one too.
        """
        self._layout = None
        self._sent.reset()
        self.wheels = self.wheels.at_start()
        self.restart_events()

    def reset_in_run(self) -> None:
        """Reset after states that got no command; the next output has the event."""
        self.reset()
        self.add_event("reset", {})

    def resume(self) -> None:
        """Get ready to control after states that another law controlled; by default like the first of a run."""
        self.reset()

    def take_over(self) -> None:
        """``resume``, but the wheels go on turning."""
        wheels = self.wheels
        self.resume()
        self.wheels = wheels

    def health(self) -> Mapping[str, float]:
        """Condition of an estimator in numbers, for diagnostics; computed only on demand."""
        return {}

    def on_applied(self, command: Command, *, own: bool) -> None:
        """Take note of the command that acts from now on; called once per period, by default without effect.

        Where commands act later (``robot.command_delay``), it is the one that ``compute`` returned so many periods ago,
        and zero with the stamp -1 before there is one.

        Args:
            command: the applied one.
            own: it is what ``compute`` returned. False: this law is idle and another one commands, or this law takes
                over from another and ``compute`` has only a share in the command, see ``Switching``.
        """
        del command, own

    def note_applied(self, command: Command, *, own: bool) -> None:
        """Let the wheels take up what acts from now on, then call ``on_applied``; for what calls ``control``."""
        self.wheels.apply(command.u, self.control_period)
        self.on_applied(command, own=own)

    def update(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Return command and telemetry for one state, of the same stamp; the command is taken as sent.

        Raises:
            CommandError: state or reference does not fit the robot or each other.
            ControlError: a value in the control law is not finite or singular.
        """
        if self.inbox is not None:
            state, reference, begins_anew = self.inbox.hear(state, reference)
            if begins_anew:
                self.reset_in_run()
        output = self.control(state, reference)
        command, own = self._sent.acting(output.command, True)
        self.note_applied(command, own=own)
        return output

    def control(self, state: RobotState, reference: Reference) -> ControlOutput:
        """``update`` without ``note_applied``, for a caller that may apply another command.

        Raises:
            CommandError: state or reference does not fit the robot or each other.
            ControlError: a value in the control law is not finite or singular.
        """
        command, blocks = self.answer(state, reference)
        telemetry = self.telemetry_of(state.stamp, blocks)
        return ControlOutput(command, telemetry, self.pending_events(state.stamp))

    def answer(self, state: RobotState, reference: Reference) -> tuple[Command, Blocks]:
        """``control`` with telemetry as ``compute`` returned it, unchecked, for a caller that has its own.

        Raises:
            CommandError: state or reference does not fit the robot or each other.
            ControlError: a value in the control law is not finite or singular.
        """
        self._check(state, reference)
        self.wheels.measure(state.wheel_momentum)
        try:
            u, blocks = self.compute(state, reference)
        except Located:
            raise
        except ControlError as error:
            raise self._failure(error.message, error.key or "u", state.stamp, error.value, error.accepted) from error
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise self._failure(str(error), "u", state.stamp) from error
        return self._command(state.stamp, self.friction.added(u, reference)), blocks

    def _check(self, state: RobotState, reference: Reference) -> None:
        if state.q.size != 7 + self.n or reference.q.size != 7 + self.n:
            sizes = (state.q.size, reference.q.size)
            accepted = f"configurations of {7 + self.n} for {self.n} joints"
            raise CommandError("does not fit the robot", key="state, reference", value=sizes, accepted=accepted)
        if reference.stamp != state.stamp:
            raise CommandError(
                "reference of another tick",
                key="reference.stamp",
                value=reference.stamp,
                accepted=f"{state.stamp} [ns]",
            )
        x, y, z, w = state.q[3:7].tolist()
        if abs(x * x + y * y + z * z + w * w - 1.0) > 2.0 * UNIT_TOLERANCE:
            raise self._failure("not a unit quaternion", "state.q", state.stamp, [x, y, z, w])

    def _command(self, stamp: int, u: Vector) -> Command:
        if np.shape(u) != (6 + self.n,):
            raise self._failure("wrong size", "u", stamp, np.shape(u), f"({6 + self.n},)")
        try:
            command = Command(stamp, u[:6], u[6:])
        except NonFiniteError as error:
            raise self._failure("not a finite number", f"u ({error.key})", stamp, error.value) from error
        if self.robot.base_mode == "free_floating" and any(command.wrench[:3].tolist()):
            value = command.wrench[:3].tolist()
            raise self._failure("force on a free-floating base", "u (command.wrench)", stamp, value, "zero force")
        return command

    def telemetry_of(self, stamp: int, blocks: Blocks) -> Telemetry:
        """The telemetry of one answer.

        Raises:
            ControlError: a number is not finite, or labels or sizes are not those of the first answer of the run.
        """
        try:
            telemetry = Telemetry.of(stamp, blocks)
        except NonFiniteError as error:
            label = next(label for label, block in blocks.items() if not np.isfinite(block).all())
            raise self._failure("not a finite number", f"telemetry ({label})", stamp, blocks[label]) from error
        layout = (telemetry.labels, telemetry.sizes)
        if self._layout is None:
            self._layout = layout
        elif layout != self._layout:
            accepted = f"labels and sizes of the first update: {self._layout}"
            raise self._failure("changed within a run", "telemetry", stamp, layout, accepted)
        return telemetry

    def _failure(self, message: str, quantity: str, stamp: int, value: object = None, accepted: str = "") -> Located:
        name = self.name or type(self).__qualname__
        time = stamp / NANOSECONDS
        return Located(f"{message} at t = {time:g} s", key=f"{name}: {quantity}", value=value, accepted=accepted)
