"""Terminal sliding mode laws without their representation of the attitude: what quaternion and Euler law share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.ntsmc.disturbance_observer import DisturbanceObserver
from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel import answer as kernel
from space_robot_control.laws.ntsmc.kernel.answer import ACTUAL, Terminal, TerminalRule, terminal_memory
from space_robot_control.laws.ntsmc.kernel.terminal import E
from space_robot_control.laws.ntsmc.sliding_mode import SlidingMode, review_loop_gain
from space_robot_control.nominal_model import NominalModel, not_finite
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.kernel.cache import cached
from space_robot_description.kernel.context import Context, context_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Vector


class TerminalSliding(Law):
    """u = M0 (x''_d + a2 + a3 - d) + C0 by one pass of nominal inverse dynamics, (27), (28); see ``SlidingMode``.

    Base translation in the inertial frame, joints as they are; subclasses name the representation of the rotation. With
    d = 0 (observer off) and a command within the limits this is the paper's u_1 + u_2 + u_3.

    Free-floating: no force acts on the base, so its translation has no sliding variable; it follows from the zero-force
    rows of the nominal model. Every (m) below is then 3+n instead of 6+n: rotation and joints, and so is x'.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: Table I by default.
    """

    Gains = SlidingGains
    uses_command_delay = True
    gain_ranges: ClassVar[GainRanges] = {
        "gamma": GainRange(0.01, 1.0),
        "k1": GainRange(1e-3, 1.0),
        "k2": GainRange(0.02, 2.0),
        "boundary_layer": GainRange(1e-4, 0.1),
    }
    telemetry_fields = ERROR_FIELDS | {
        "sliding_variable": "s [m, rad]",
        "sliding_excess": "Delta s, s outside the boundary layer [m, rad]",
        "xi": "xi = |e'|^(r-1) / Gamma Delta s [-]",
        "adaptive_gain": "K_hat, as used for this command [m/s2, rad/s2]",
        "eta_error": "scalar part of the error quaternion, signed [-]",
        "loop_gain": "shift of s by one held command, over s; above about 1 the DoF chatters [-]",
        "command_unsaturated": "u before the limits of the nominal actuators [N, N m]",
        "command_norm": "norm of command_unsaturated [N, N m]",
        "command_saturated": "1: it was beyond the limits; the command fits, so the plant's own flags stay 0 [-]",
        "disturbance_estimate": "d of the observer [m/s2, rad/s2]",
    }
    gains: SlidingGains

    def __init__(self, robot: Robot, control_period: float, gains: SlidingGains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model, self.limits = NominalModel(robot), CommandLimits(robot)
        self.skip = 3 if robot.base_mode == "free_floating" else 0
        self.sliding = self._sliding_mode(self.gains)
        self.observer = DisturbanceObserver(self.gains.disturbance_observer, control_period, 6 + robot.n)
        self.memory = terminal_memory(robot.n, 6 + robot.n - self.skip, len(robot.mimics))
        self.layout = _layout(robot.n, 6 + robot.n - self.skip)
        self._answer = Answering(kernel.answer, robot.n, self.layout)
        # What the own commands that do not act yet cause, by stamp.
        self._accelerations: dict[int, Vector | None] = {}
        self._context = self._bind()
        self.memory.angles[ACTUAL] = self.start

    @classmethod
    def must_compile(cls) -> bool:
        """True before the first terminal sliding mode law on a machine."""
        return not cached(Path(kernel.__file__), kernel.answer.__name__)

    def retune(self, gains: SlidingGains) -> None:
        """Go on with other Gamma, K_1, K_2 or Phi and the K_hat that was adapted."""
        mode = self._sliding_mode(gains)
        mode.adopt(self.sliding.estimate)
        self.sliding = mode
        self._context = self._bind()

    def _sliding_mode(self, gains: SlidingGains) -> SlidingMode:
        gamma, k2 = (gain[self.skip :].tolist() for gain in (gains.gamma_of(self.robot), gains.k2_of(self.robot)))
        return SlidingMode(gains, gamma, k2, range(3 - self.skip, 6 - self.skip), self.control_period)

    def reset(self) -> None:
        """Forget K_hat, the disturbance estimate and the branch of angles."""
        super().reset()
        self.sliding.reset()
        self.observer.reset()
        self._accelerations = {}
        self.memory.disturbance[:] = 0.0
        self.memory.angles[:] = 0.0
        self.memory.angles[ACTUAL] = self.start

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw | None:
        """The law without its observer, which is Python."""
        return None if self.gains.disturbance_observer else CompiledLaw(kernel.answer, self._context, self.layout)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the inverse dynamics of the nominal model is not finite.
        """
        observed, memory = bool(self.gains.disturbance_observer), self.memory
        if observed:
            memory.disturbance[:] = self.observer.update(state.v)
        status, u, row = self._answer(self._context, state, reference, self.wheels.momentum)
        if status:
            raise not_finite(memory.acceleration)
        blocks = self.layout.blocks(row)
        if observed:
            # The acceleration under a clipped command is not known here; the estimate then pauses.
            self._accelerations[state.stamp] = None if blocks["command_saturated"] else memory.acceleration.copy()
        return u, blocks

    def on_applied(self, command: Command, *, own: bool) -> None:
        """The acceleration under another law's command is not known here; the disturbance estimate then pauses."""
        self.observer.expect(self._accelerations.get(command.stamp) if own else None)
        self._accelerations = {stamp: a for stamp, a in self._accelerations.items() if stamp > command.stamp}

    def review(self, path: Sequence[Reference]) -> Review:
        """Judge the loop gain per DoF at the rates that the start error leads to."""
        self.reset()
        start, reference = path[0], path[1]
        state = RobotState(reference.stamp, start.q, start.v, np.zeros(self.n), np.zeros(3))
        self._answer(self._context, state, reference, self.wheels.momentum)
        e = self.memory.errors[E].tolist()
        self.reset()
        return review_loop_gain(self.sliding, e, self.robot.joint_names, self.control_period, self.gains.clamp)

    def rotation(self, state: RobotState, reference: Reference) -> Vector:
        """Return the errors (4, 3) of the base rotation, as ``kernel/terminal.py`` names the rows; one answer is given.

        Args:
            state: as for ``compute``.
            reference: of the same stamp.
        """
        self._answer(self._context, state, reference, self.wheels.momentum)
        return self.memory.rotation.copy()

    @property
    def start(self) -> tuple[float, float, float]:
        """The angles that the first ones are nearest to [rad]."""
        return 0.0, 0.0, 0.0

    def _bind(self) -> Context:
        """What compiled code works on: these gains, this K_hat."""
        gains, adaptation = self.gains, self.gains.adaptation
        rule = TerminalRule(
            attitude=int(self.attitude()),
            floating=int(self.skip > 0),
            mass=self.model.mass,
            gyroscopic=int(gains.gyroscopic),
            preserve=int(gains.saturation == "direction_preserving"),
            keep=self.sliding.keep,
            cap=self.sliding.cap,
            rate=adaptation.rate,
            freeze=int(adaptation.freeze_on_saturation),
            min_cosine=self.smallest_cosine(),
        )
        self.memory = self.memory._replace(estimate=self.sliding.array)
        return context_of(
            Terminal(rule, self.sliding.rule, self.memory, self.model.arrays, self.limits.numbers), kernel.keep
        )

    @abstractmethod
    def attitude(self) -> int:
        """How the attitude is represented, as ``kernel/answer.py`` names it."""

    def smallest_cosine(self) -> float:
        """Lower bound of |cos pitch|, of laws with angles."""
        return 1.0


def _layout(n: int, m: int) -> Layout:
    """The blocks of the telemetry of m sliding variables."""
    errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
    per_dof = ("sliding_variable", "sliding_excess", "xi", "adaptive_gain")
    terms = {**dict.fromkeys(per_dof, m), "eta_error": 1, "loop_gain": m}
    command = {"command_unsaturated": 6 + n, "command_norm": 1, "command_saturated": 1, "disturbance_estimate": 6 + n}
    return Layout.of({**errors, **terms, **command})
