"""What the terminal sliding mode laws share: all but how they write the attitude of the base."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.disturbance import DisturbanceObserver
from space_robot_control.laws.dynamics import NominalModel
from space_robot_control.laws.limits import CommandLimits
from space_robot_control.laws.ntsmc_gains import SlidingGains
from space_robot_control.laws.sliding import Floats, SlidingMode, SlidingTerms
from space_robot_control.laws.sliding_review import review_loop_gain
from space_robot_control.laws.tracking import TrackingErrors, error_blocks, tracking_errors
from space_robot_control.rotations import Three, cross, rotate, rotate_inverse
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Vector


@dataclass(frozen=True, slots=True)
class RotationErrors:
    """The base rotation as one representation of it sees it; every vector (3).

    Attributes:
        e: error, actual minus desired.
        rate: what the sliding variable takes for its rate.
        e_dot: the derivative of e.
        desired: the desired acceleration of the representation.
        coordinates: what ``TerminalSliding.angular`` needs beside the acceleration.
    """

    e: Three
    rate: Three
    e_dot: Three
    desired: Three
    coordinates: tuple[float, ...] = ()


class TerminalSliding(Law):
    """u = M0 (x''_d + a2 + a3 - d) + C0 by one pass of nominal inverse dynamics, (27), (28); see ``SlidingMode``.

    Base translation in the inertial frame, joints as they are; subclasses write the rotation. With d = 0 (observer
    off) and a command within the limits this is the paper's u_1 + u_2 + u_3.

    Free-floating: no force acts on the base, so its translation has no sliding variable; it follows from the zero-force
    rows of the nominal model. Every (m) below is then 3+n instead of 6+n: rotation and joints, and so is x'.

    Telemetry: the errors every law shows, ``sliding_variable`` s (m), ``sliding_excess`` Delta s (m), ``xi`` (m),
    ``adaptive_gain`` K_hat (m) [m/s2, rad/s2], ``eta_error`` [-], ``loop_gain`` (m) [-], ``command_unsaturated`` (6+n)
    [N, N m], ``command_norm`` of it, ``command_saturated`` (1 where it was beyond the nominal actuators: what is sent
    fits, so the plant's own flags stay 0), ``disturbance_estimate`` d (6+n) [m/s2, rad/s2].

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: Table I by default.
    """

    Gains = SlidingGains
    gains: SlidingGains

    def __init__(self, robot: Robot, control_period: float, gains: SlidingGains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model, self.limits = NominalModel(robot), CommandLimits(robot)
        self.skip = 3 if robot.base_mode == "free_floating" else 0
        self.sliding = self._sliding_mode(self.gains)
        self.observer = DisturbanceObserver(self.gains.disturbance_observer, control_period, 6 + robot.n)

    def retune(self, gains: SlidingGains) -> None:
        """Go on with other Gamma, K_1, K_2 or Phi and the K_hat that was adapted."""
        sliding = self._sliding_mode(gains)
        sliding.adopt(self.sliding.estimate)
        self.sliding = sliding

    def _sliding_mode(self, gains: SlidingGains) -> SlidingMode:
        gamma, k2 = (gain[self.skip :].tolist() for gain in (gains.gamma_of(self.robot), gains.k2_of(self.robot)))
        return SlidingMode(gains, gamma, k2, range(3 - self.skip, 6 - self.skip), self.control_period)

    @abstractmethod
    def rotation(self, state: RobotState, reference: Reference, errors: TrackingErrors) -> RotationErrors:
        """Return the errors of the base rotation; may remember the branch it is on."""

    @abstractmethod
    def angular(self, state: RobotState, rotation: RotationErrors, acceleration: Floats) -> Three:
        """Return the derivative of the body rates [rad/s2] for an acceleration of the representation (3)."""

    def reset(self) -> None:
        """Forget K_hat and the disturbance estimate."""
        super().reset()
        self.sliding.reset()
        self.observer.reset()

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        errors = tracking_errors(state, reference)
        rotation = self.rotation(state, reference, errors)
        speed = state.v[self.skip :]
        speed_squared = float(speed @ speed)
        terms = self.sliding.terms(*self._stacked(state, rotation, errors), speed_squared)
        disturbance = self.observer.update(state.v)
        wished = self._acceleration(state, rotation, errors, terms) - disturbance
        u, wished = self.model.actuated_inverse_dynamics(state.q, state.v, wished)
        saturated = not self.limits.fits(u)
        blocks = {
            **error_blocks(errors),
            "sliding_variable": np.array(terms.s),
            "sliding_excess": np.array(terms.delta),
            "xi": np.array(terms.xi),
            "adaptive_gain": np.array(self.sliding.estimate),
            "eta_error": float(state.q[3:7] @ reference.q[3:7]),
            "loop_gain": np.array(terms.loop_gain),
            "command_unsaturated": u,
            "command_norm": float(u @ u) ** 0.5,
            "command_saturated": float(saturated),
            "disturbance_estimate": disturbance,
        }
        self.sliding.adapt(terms.xi, speed_squared, saturated=saturated)
        # What a clipped command leads to is not known here; the estimate then waits.
        self.observer.expect(None if saturated else wished)
        return (self._fitted(state, rotation, u) if saturated else u), blocks

    def hold(self, command: Command, *, own: bool) -> None:
        """What another law has a part in leads to what is not known here; the disturbance estimate then waits."""
        if not own:
            self.observer.expect(None)

    def review(self, path: Sequence[Reference]) -> Review:
        """Judge the loop gain per DoF at the rates the start error will lead to, before flying."""
        self.reset()
        start, reference = path[0], path[1]
        state = RobotState(reference.stamp, start.q, start.v, np.zeros(self.n), np.zeros(3))
        errors = tracking_errors(state, reference)
        e, _, _ = self._stacked(state, self.rotation(state, reference, errors), errors)
        self.reset()
        return review_loop_gain(self.sliding, e, self.robot.joint_names, self.control_period, self.gains.clamp)

    def _stacked(
        self, state: RobotState, rotation: RotationErrors, errors: TrackingErrors
    ) -> tuple[Floats, Floats, Floats]:
        """e, e' and the derivative of e (m): [translation in the inertial frame, rotation, joints]."""
        # TrackingErrors are desired minus actual, base parts in the body frame.
        far, fast = (-errors.configuration).tolist(), (-errors.velocity).tolist()
        if self.skip:
            return (*rotation.e, *far[6:]), (*rotation.rate, *fast[6:]), (*rotation.e_dot, *fast[6:])
        q = state.q[3:7].tolist()
        linear = rotate(q, fast[:3])
        return (
            (*rotate(q, far[:3]), *rotation.e, *far[6:]),
            (*linear, *rotation.rate, *fast[6:]),
            (*linear, *rotation.e_dot, *fast[6:]),
        )

    def _acceleration(
        self, state: RobotState, rotation: RotationErrors, errors: TrackingErrors, terms: SlidingTerms
    ) -> Vector:
        """The derivative of v that gives x''_d + a2 + a3; R^T (a_d + a) - w x v for the translation."""
        push = [0.0] * self.skip + [a2 + a3 for a2, a3 in zip(terms.equivalent, terms.reaching, strict=True)]
        turn = [desired + a for desired, a in zip(rotation.desired, push[3:6], strict=True)]
        linear = rotate_inverse(state.q[3:7].tolist(), push[:3])
        out: Vector = errors.feedforward + np.array((*linear, 0.0, 0.0, 0.0, *push[6:]))
        # The feed-forward holds the rotation error of the body frame; here its frame is the representation's.
        out[3:6] = self.angular(state, rotation, turn)
        return out

    def _fitted(self, state: RobotState, rotation: RotationErrors, u: Vector) -> Vector:
        """The command within the nominal limits; C0 is the u of x'' = 0."""
        if self.gains.saturation == "per_axis":
            return self.limits.per_axis(u)
        still, v = np.zeros(6 + self.n), state.v[:6].tolist()
        still[:3] = cross(v[:3], v[3:])
        still[3:6] = self.angular(state, rotation, (0.0, 0.0, 0.0))
        bias, _ = self.model.actuated_inverse_dynamics(state.q, state.v, still)
        return self.limits.direction_preserving(u, bias)
