"""LQR, a baseline: feed-forward through the nominal model, and the optimal gain of its posture."""

from __future__ import annotations

from collections.abc import Sequence
from math import log
from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.lqr.linear_model import Accepted, Design, make_design
from space_robot_control.nominal_model import NominalModel
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_description.actuation import torque_capacity
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


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

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)
        self._first = 3 if robot.base_mode == "free_floating" else 0
        self._effort = _limits(robot, type(self).name)[self._first :]
        self._design: Design | None = None
        self._designs = 0
        self.retune(self.gains)

    def retune(self, gains: Gains) -> None:
        """Go on with other accepted errors, from the next update on."""
        error = np.full(6 + self.n, gains.base_error)
        error[6:] = expand(gains.joint_error, self.robot.joint_names, "controller.gains.joint_error")
        error = error[self._first :]
        self._accepted = Accepted(error, error / gains.time, self._effort)
        self._design = None

    def reset(self) -> None:
        """Forget the posture."""
        super().reset()
        self._design, self._designs = None, 0

    def review(self, path: Sequence[Reference]) -> Review:
        """Find how fast the sampled loop is where the robot starts."""
        radius = make_design(self.model, path[0].q, self.control_period, self._accepted).radius
        slowest = -self.control_period / log(radius)
        return Review((f"{self.name}: slowest pole of the nominal loop at the start decays in {slowest:.3g} s",))

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: there is no gain that stabilises, or the inverse dynamics are not finite.
        """
        errors = tracking_errors(state, reference)
        u, _ = self.model.actuated_inverse_dynamics(state.q, state.v, errors.feedforward)
        if self.gains.gyroscopic:
            self.wheels.add_torque(u, state.v[3:6])
        scaled = (
            errors.configuration[self._first :] / self._accepted.error,
            errors.velocity[self._first :] / self._accepted.rate,
        )
        feedback, more = self._feedback(self._design_at(state), np.concatenate(scaled), u)
        u[self._first :] += feedback
        return u, {**error_blocks(errors), "feedback": feedback, "designs": self._designs, **more}

    def _feedback(self, design: Design, x: Vector, feedforward: Vector) -> tuple[Vector, Blocks]:
        """What is added to the feed-forward u (6+n,) for x (2m,), (m,) [N, N m], and telemetry of its own."""
        del feedforward
        return -self._effort * (design.gain @ x), {}

    def _design_at(self, state: RobotState) -> Design:
        """The regulator in force: that of the last posture, or a new one where the arm has left it."""
        design = self._design
        if design is None or float(np.abs(state.joints - design.joints).max(initial=0.0)) > self.gains.posture_step:
            design = make_design(self.model, state.q, self.control_period, self._accepted)
            self._design, self._designs = design, self._designs + 1
        return design


def _limits(robot: Robot, name: str) -> Vector:
    """Largest force, torque and effort of every actuator (6+n,) [N, N m]."""
    force = robot.actuators.base_force
    limits = np.concatenate([force.limit if force else np.ones(3), torque_capacity(robot)[0], robot.effort_limit])
    if not (np.isfinite(limits).all() and (limits > 0.0).all()):
        accepted = "a positive limit of every actuator, which is what errors are weighed against"
        raise SpecError(f"{name} needs limits", key="robot.actuators", value=limits.tolist(), accepted=accepted)
    return limits
