"""LQR, a baseline: feed-forward through the nominal model, and the optimal gain of its posture."""

from __future__ import annotations

from collections.abc import Sequence
from math import log
from pathlib import Path
from types import ModuleType
from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.kernel.answers import UNUSABLE
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.lqr.kernel import answer as kernel
from space_robot_control.laws.lqr.kernel.design import DesignMemory, RegulatorRule
from space_robot_control.laws.lqr.kernel.regulator import MADE, regulator_memory
from space_robot_control.laws.lqr.kernel.riccati import UNSOLVED, UNSTABLE
from space_robot_control.nominal_model import NominalModel, not_finite
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.actuation import torque_capacity
from space_robot_description.fields import DYNAMIC
from space_robot_description.kernel.cache import cached
from space_robot_description.kernel.context import Context, context_of
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

INPUTS = "a model with inputs"


class Lqr(Law):
    """u = M0(q) a_ff + c0(q, v) + omega x h - K x, x = [e_x, e_v], K the optimal gain of the sampled linear model.

    The model is the nominal robot at rest in a posture, e'' = -M0^-1 w with w held over a period T; K minimises the sum
    of (e / e_s)^2 + (e' tau / e_s)^2 + (w / u_s)^2 over all periods and degrees of freedom: e_s accepted errors, tau
    the time they may take, u_s the limits of the actuators (Bryson's rule). K is computed at the first state, and again
    where a joint is more than ``posture_step`` from where it was computed. Feed-forward, e_x and e_v are those of
    ``TrackingErrors``.

    Free-floating: the translation is eliminated, see ``NominalModel``; the force on the base is exactly zero.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: base_error, joint_error, time, posture_step, gyroscopic.

    Raises:
        SpecError: an actuator without a limit, or a joint that the robot does not have.

    The equations on one screen: ``reference.py``.

    Reference: Anderson and Moore, "Optimal Control: Linear Quadratic Methods", 1990; Bryson and Ho, "Applied Optimal
    Control", 1975, sec. 5.2.
    """

    class Gains(Law.Gains):
        """Gains of the regulator."""

        base_error: PositiveFloat = Field(
            default=0.05,
            description="accepted error of the base, rotation [rad] and translation [m]",
            json_schema_extra=DYNAMIC,
        )
        joint_error: PositiveFloat | tuple[PositiveFloat, ...] | dict[str, PositiveFloat] = Field(
            default=0.2,
            description="accepted error, one number, a list or by joint name [rad or m]",
            json_schema_extra=DYNAMIC,
        )
        time: PositiveFloat = Field(
            default=2.0,
            description="tau: accepted are rates of accepted error / tau [s]",
            json_schema_extra=DYNAMIC,
        )
        posture_step: PositiveFloat = Field(
            default=0.1, description="motion of a joint after which K is computed again [rad or m]"
        )
        gyroscopic: bool = Field(default=True, description="include omega x h of the wheels' momentum in the command")

    name = "lqr"
    gain_ranges: ClassVar[GainRanges] = {
        "base_error": GainRange(0.001, 10.0),
        "joint_error": GainRange(0.001, 10.0),
        "time": GainRange(0.1, 50.0),
    }
    telemetry_fields = ERROR_FIELDS | {
        "feedback": "w, what is added to the feed-forward, of the actuated degrees of freedom [N, N m]",
        "designs": "postures for which K was computed so far [-]",
    }
    gains: Gains
    _kernel: ClassVar[ModuleType] = kernel

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)
        self._first = 3 if robot.base_mode == "free_floating" else 0
        self._effort = _limits(robot, type(self).name)[self._first :]
        self._memory = regulator_memory(robot.n, self._effort.size, self._periods(), len(robot.mimics))
        self._row = self._telemetry_layout()
        self._answer = Answering(self._kernel.answer, robot.n, self._row)
        self.retune(self.gains)

    @classmethod
    def must_compile(cls) -> bool:
        """True before the first such law on a machine."""
        return not cached(Path(str(cls._kernel.__file__)), cls._kernel.answer.__name__)

    def retune(self, gains: Gains) -> None:
        """Go on with other accepted errors, from the next update on."""
        error = np.full(6 + self.n, gains.base_error)
        error[6:] = expand(gains.joint_error, self.robot.joint_names, "controller.gains.joint_error")
        error = error[self._first :]
        numbers = gains.posture_step, self.control_period, self.model.mass, int(self._first > 0), int(gains.gyroscopic)
        self._context = self._context_of(RegulatorRule(error, error / gains.time, self._effort, *numbers))
        self._memory.counts[MADE] = 0

    def reset(self) -> None:
        """Forget the posture."""
        super().reset()
        self._memory.counts[:] = 0

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw:
        """The law for compiled runs."""
        return CompiledLaw(self._kernel.answer, self._context, self._row)

    def review(self, path: Sequence[Reference]) -> Review:
        """Find how fast the sampled loop is where the robot starts."""
        start, still = path[0], np.zeros(6 + self.n)
        at_rest = RobotState(start.stamp, start.q, still, np.zeros(self.n), np.zeros(3))
        self._memory.counts[:] = 0
        self._answered(at_rest, Reference(start.stamp, start.q, still, still))
        self._memory.counts[:] = 0
        slowest = -self.control_period / log(np.abs(np.linalg.eigvals(self.design.closed)).max())
        return Review((f"{self.name}: slowest pole of the nominal loop at the start decays in {slowest:.3g} s",))

    @property
    def design(self) -> DesignMemory:
        """The regulator of the last posture."""
        return self._memory.design

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: there is no gain that stabilises, or the inverse dynamics are not finite.
        """
        _, u, row = self._answered(state, reference)
        return u, self._row.blocks(row)

    def _answered(self, state: RobotState, reference: Reference) -> tuple[int, Vector, Vector]:
        """Status, u (6+n,) and row of telemetry of one answer; a status that has no words is a subclass's own."""
        status, u, row = self._answer(self._context, state, reference, self.wheels.momentum)
        if status == UNUSABLE:
            raise not_finite(self._memory.acceleration)
        if status == UNSOLVED:
            raise ControlError("the Riccati equation has no solution that is found", key="X", accepted=INPUTS)
        if status == UNSTABLE:
            raise ControlError("the gain does not stabilise", key="K", accepted="all poles inside 1")
        return status, u, row

    def _periods(self) -> int:
        """How many are looked ahead; one is enough where no limit is looked at."""
        return 1

    def _telemetry_layout(self) -> Layout:
        n, m = self.n, self._effort.size
        errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
        return Layout.of({**errors, "feedback": m, "designs": 1})

    def _context_of(self, rule: RegulatorRule) -> Context:
        return context_of(kernel.RegulatorContext(rule, self._memory, self.model.arrays), kernel.keep)


def _limits(robot: Robot, name: str) -> Vector:
    """Largest force, torque and effort of every actuator (6+n,) [N, N m]."""
    force = robot.actuators.base_force
    limits = np.concatenate([force.limit if force else np.ones(3), torque_capacity(robot)[0], robot.effort_limit])
    if not (np.isfinite(limits).all() and (limits > 0.0).all()):
        accepted = "a positive limit of every actuator, which is what errors are weighed against"
        raise SpecError(f"{name} needs limits", key="robot.actuators", value=limits.tolist(), accepted=accepted)
    return limits
