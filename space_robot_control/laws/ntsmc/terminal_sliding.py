"""Terminal sliding mode laws without their representation of the attitude: what quaternion and Euler law share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.ntsmc.disturbance_observer import DisturbanceObserver
from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel import sliding
from space_robot_control.laws.ntsmc.kernel.sliding import DELTA, LOOP_GAIN, XI, S
from space_robot_control.laws.ntsmc.kernel.terminal import DESIRED, accelerate, stack
from space_robot_control.laws.ntsmc.sliding_mode import SlidingMode, review_loop_gain
from space_robot_control.nominal_model import NominalModel
from space_robot_control.tracking import ERROR_FIELDS, TrackingErrors, error_blocks, tracking_errors
from space_robot_description.kernel.cache import cached
from space_robot_description.kernel.jit import ready
from space_robot_description.robot import Robot
from space_robot_description.rotations import cross
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Vector


class TerminalSliding(Law):
    """u = M0 (x''_d + a2 + a3 - d) + C0 by one pass of nominal inverse dynamics, (27), (28); see ``SlidingMode``.

    Base translation in the inertial frame, joints as they are; subclasses write the rotation. With d = 0 (observer
    off) and a command within the limits this is the paper's u_1 + u_2 + u_3.

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
        # What the own commands that do not act yet cause, by stamp.
        self._accelerations: dict[int, Vector | None] = {}
        q, own, rows = Reference(0, np.zeros(7), np.zeros(6), np.zeros(6)).q, np.zeros(6), np.zeros((4, 3))
        ready(stack, q, own, own, rows, rows)
        ready(accelerate, q, own, own, rows, own, own)

    @classmethod
    def must_compile(cls) -> bool:
        """True before the first terminal sliding mode law on a machine."""
        return not cached(Path(sliding.__file__), sliding.slide.__name__)

    def retune(self, gains: SlidingGains) -> None:
        """Go on with other Gamma, K_1, K_2 or Phi and the K_hat that was adapted."""
        mode = self._sliding_mode(gains)
        mode.adopt(self.sliding.estimate)
        self.sliding = mode

    def _sliding_mode(self, gains: SlidingGains) -> SlidingMode:
        gamma, k2 = (gain[self.skip :].tolist() for gain in (gains.gamma_of(self.robot), gains.k2_of(self.robot)))
        return SlidingMode(gains, gamma, k2, range(3 - self.skip, 6 - self.skip), self.control_period)

    @abstractmethod
    def rotation(self, state: RobotState, reference: Reference, errors: TrackingErrors) -> Vector:
        """Return the base rotation in the law's representation; may remember the branch it is on.

        Returns:
            (4, 3): error, actual minus desired; its rate in the sliding variable; the derivative of the error; and the
            desired acceleration of the representation.
        """

    @abstractmethod
    def angular(self, state: RobotState, acceleration: Vector) -> Sequence[float] | Vector:
        """Return the derivative (3,) of the body rates for an acceleration (3,) of the representation [rad/s2].

        Args:
            state: that ``rotation`` was last called with.
            acceleration: of the representation.
        """

    def reset(self) -> None:
        """Forget K_hat and the disturbance estimate."""
        super().reset()
        self.sliding.reset()
        self.observer.reset()
        self._accelerations = {}

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        errors = tracking_errors(state, reference)
        rotation = self.rotation(state, reference, errors)
        speed = state.v[self.skip :]
        speed_squared = float(speed @ speed)
        e, rate, e_dot = self._stacked(state, rotation, errors)
        terms = self.sliding.terms(e, rate, e_dot, speed_squared)
        disturbance = self.observer.update(state.v)
        acceleration = self._acceleration(state, rotation, errors.feedforward, terms) - disturbance
        u, acceleration = self.model.actuated_inverse_dynamics(state.q, state.v, acceleration)
        self._add_wheels(u, state)
        saturated = not self.limits.fits(u)
        blocks = {
            **error_blocks(errors),
            "sliding_variable": terms[S],
            "sliding_excess": terms[DELTA],
            "xi": terms[XI],
            "adaptive_gain": self.sliding.estimate,
            "eta_error": float(state.q[3:7] @ reference.q[3:7]),
            "loop_gain": terms[LOOP_GAIN],
            "command_unsaturated": u,
            "command_norm": float(u @ u) ** 0.5,
            "command_saturated": float(saturated),
            "disturbance_estimate": disturbance,
        }
        self.sliding.adapt(terms[XI], speed_squared, saturated=saturated)
        # The acceleration under a clipped command is not known here; the estimate then pauses.
        self._accelerations[state.stamp] = None if saturated else acceleration
        return (self._within_limits(state, u) if saturated else u), blocks

    def on_applied(self, command: Command, *, own: bool) -> None:
        """The acceleration under another law's command is not known here; the disturbance estimate then pauses."""
        self.observer.expect(self._accelerations.get(command.stamp) if own else None)
        self._accelerations = {stamp: a for stamp, a in self._accelerations.items() if stamp > command.stamp}

    def review(self, path: Sequence[Reference]) -> Review:
        """Judge the loop gain per DoF at the rates that the start error leads to."""
        self.reset()
        start, reference = path[0], path[1]
        state = RobotState(reference.stamp, start.q, start.v, np.zeros(self.n), np.zeros(3))
        errors = tracking_errors(state, reference)
        e = self._stacked(state, self.rotation(state, reference, errors), errors)[0].tolist()
        self.reset()
        return review_loop_gain(self.sliding, e, self.robot.joint_names, self.control_period, self.gains.clamp)

    def _stacked(self, state: RobotState, rotation: Vector, errors: TrackingErrors) -> Vector:
        """e, e' and the derivative of e, (3, m): [translation in the inertial frame, rotation, joints]."""
        out = np.empty((3, 6 + self.n - self.skip))
        stack(state.q, errors.configuration, errors.velocity, rotation, out)
        return out

    def _acceleration(self, state: RobotState, rotation: Vector, feedforward: Vector, terms: Vector) -> Vector:
        """The derivative of v that gives x''_d + a2 + a3; R^T (a_d + a) - w x v for the translation."""
        out, turned = np.empty(6 + self.n), np.empty(3)
        accelerate(state.q, feedforward, rotation[DESIRED], terms, turned, out)
        out[3:6] = self.angular(state, turned)
        return out

    def _add_wheels(self, u: Vector, state: RobotState) -> None:
        if self.gains.gyroscopic:
            self.wheels.add_torque(u, state.v[3:6])

    def _within_limits(self, state: RobotState, u: Vector) -> Vector:
        """The command within the nominal limits; C0 is the u of x'' = 0."""
        if self.gains.saturation == "per_axis":
            return self.limits.per_axis(u)
        still, v = np.zeros(6 + self.n), state.v[:6].tolist()
        still[:3] = cross(v[:3], v[3:])
        still[3:6] = self.angular(state, np.zeros(3))
        bias, _ = self.model.actuated_inverse_dynamics(state.q, state.v, still)
        self._add_wheels(bias, state)
        return self.limits.direction_preserving(u, bias)
