"""Adaptive control by linear separation of the inertial parameters, after Liu, Teng, Jin (2023)."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, degrees, radians

import numpy as np

from space_robot_control.euler import (
    PITCH,
    ROLL,
    YAW,
    body_torque,
    difference,
    euler_acceleration,
    euler_state,
)
from space_robot_control.laws.adaptive_gains import AdaptiveGains
from space_robot_control.laws.adaptive_review import AdaptiveReview
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.parameter_update import Held, ParameterUpdate
from space_robot_control.laws.regressor import Regressor
from space_robot_control.laws.wheels import WheelMomentum, gyroscopic
from space_robot_control.rotations import from_rpy, rotate_inverse
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

Motion = tuple[Vector, Vector, Vector]


class Adaptive(Law):
    """u = Y(Theta, Theta', Theta_r', Theta_r'') pi_hat + K_D sigma, with pi_hat corrected in flight.

    In Euler coordinates Theta, desired minus actual e = Theta_d - Theta:

        Theta_r' = Theta_d' + Lambda e,   Theta_r'' = Theta_d'' + Lambda e',   sigma = e' + Lambda e      (32), (33)

    With exact parameters and a short period e' = -Lambda e + sigma and M sigma' + C sigma + K_D sigma = 0. The other
    reading, ``lambda_on: velocity``, is Theta_r' = Theta_d', Theta_r'' = Theta_d'', sigma = Lambda e' + e: a PD law
    whose damping Lambda weighs, and the one under which the paper's Fig. 10 appears.

    Free-floating robots: the three rows of zero force give the translation, p_r'' = -(Y_p pi_hat) / m_hat, and the
    velocity error it entails, sigma_p = -(M_pr sigma) / m_hat; no accelerometer and no algebraic loop is needed.
    Free-flying robots: translation is controlled like the rest.

    Updates (``update``): ``none``; ``rls`` (39)-(41); ``lyapunov`` pi_hat' = Gamma Y^T [sigma_p, sigma] (44);
    ``composite``: RLS and (44) with Gamma = gamma G, G the covariance.

    Telemetry: euler_error (3: roll, pitch, yaw) [rad], joint_error (n) [rad], position_error (3, inertial; free-flying)
    [m], sliding_variable (m: translation if free-flying, roll, pitch, yaw, joints) [m/s, rad/s], lyapunov_function
    (sigma^T M_hat sigma / 2 + e^T Lambda K_D e) [J], parameters (10 (1+n)), consistent (1: every body can exist), and
    with RLS innovation (m) [N, N m], surprise (innovation over its variance) [-], covariance_trace, resets, learned
    (0: the base saturated and the period taught nothing).

    Deviations from the paper: the base translation is not eliminated from the parametrisation (the virtual manipulator
    of sec. 2 makes the dynamics nonlinear in pi) but from the command; both Y of (38) and (44) are Slotine-Li's with
    four arguments; K_D = kappa M(pi_0, Theta_0) is the full matrix, M reduced by the free translation; (40) is weighted
    by the torque noise, in square-root form and with a reset; (44) has the term of translation; ``lead`` and
    ``consistency`` are ours. docs/papers/liu2023.md lists the errata.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        gains: see ``AdaptiveGains``.

    Raises:
        SpecError: the gains do not fit the robot.

    Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023; Slotine and Li, IJRR 6(3), 1987.
    """

    class Gains(AdaptiveGains, Law.Gains):
        """Gains of the adaptive law."""

    name = "adaptive"
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.regressor = Regressor(robot)
        self._free = robot.base_mode == "free_floating"
        self._first = 3 if self._free else 0
        self._lambda = self.gains.lambda_.values(robot, "controller.gains.lambda")[self._first :]
        self._pitch_limit = radians(self.gains.pitch_limit_deg)
        self.reset()

    def reset(self) -> None:
        """Forget the past: estimate, covariance and damping matrix are those of the start again."""
        super().reset()
        self._update = ParameterUpdate(self.robot, self.regressor, self.gains, self.control_period)
        self._wheels = WheelMomentum(self.robot, known=self.gains.gyroscopic)
        self._damping: Vector | None = None
        self._last_acceleration: Vector | None = None

    def review(self, path: Sequence[Reference]) -> Review:
        """The sampled-data stability rule along the path, see ``stability.stable_lambda``."""
        return AdaptiveReview(self.robot, self.regressor, self.gains, self.control_period).along(path)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the attitude is near the singularity of Euler angles, K_D is not positive definite, or the
                estimate is lost.
        """
        x, dx = euler_state(state)
        self._check_pitch(x)
        self._update.observe(state, x, dx)
        if self._damping is None:
            self._damping = self._damping_matrix(x)
        desired = self._desired(reference)
        at, rate = self._ahead(x, dx, desired[2]) if self.gains.lead else (x, dx)
        error = difference(desired[0], at)[self._first :]
        sigma, rate_r, acceleration_r = self._references(error, rate, desired)
        rows = self._regressor_rows(at, rate, rate_r, acceleration_r)
        generalised = rows @ self._update.estimate
        generalised[self._first :] += self._damping @ sigma
        entailed, energy = self._entailed(at, sigma)
        value = 0.5 * energy + float((self._lambda * error) @ self._damping @ error)
        u = self._in_body(at, generalised)
        u[3:6] += gyroscopic(state.v[3:6], self._wheels.momentum)
        blocks = {**self._error_blocks(error, sigma), "lyapunov_function": value, **self._update.blocks()}
        self._update.track(rows, entailed)
        self._hold(state, x, dx, u[:6])
        return u, blocks

    def _hold(self, state: RobotState, x: Vector, dx: Vector, wrench: Vector) -> None:
        """Remember what acts from now on, for the update and for the wheels."""
        middle = self._wheels.after(wrench[3:], 0.5 * self.control_period)
        self._update.hold(Held(x, dx, state.v[3:6], middle, wrench))
        self._wheels.momentum = self._wheels.after(wrench[3:], self.control_period)

    def _references(self, error: Vector, rate: Vector, desired: Motion) -> tuple[Vector, Vector, Vector]:
        """Return sigma (m,), Theta_r' and Theta_r'' (6+n,); the unactuated part of the latter is zero."""
        first, (_, rate_d, acceleration_d) = self._first, desired
        error_rate = (rate_d - rate)[first:]
        rate_r, acceleration_r = np.zeros(rate.size), np.zeros(rate.size)
        rate_r[first:], acceleration_r[first:] = rate_d[first:], acceleration_d[first:]
        if self.gains.lambda_on == "velocity":
            return self._lambda * error_rate + error, rate_r, acceleration_r
        rate_r[first:] += self._lambda * error
        acceleration_r[first:] += self._lambda * error_rate
        return error_rate + self._lambda * error, rate_r, acceleration_r

    def _regressor_rows(self, x: Vector, dx: Vector, dx_r: Vector, ddx_r: Vector) -> Vector:
        """Y (6+n, P); for a free base with the translation that needs no force."""
        rows = self.regressor.slotine_li(x, dx, dx_r, ddx_r)
        if self._free:
            push = np.zeros(dx.size)
            push[:3] = rows[:3] @ self._update.estimate / -self._update.mass
            rows += self.regressor.inertia(x, push)
        return rows

    def _entailed(self, x: Vector, sigma: Vector) -> tuple[Vector, float]:
        """Return sigma (6+n,) with the translation it entails, and sigma^T M_hat sigma."""
        full = np.zeros(6 + self.n)
        full[self._first :] = sigma
        momentum = self.regressor.inertia(x, full) @ self._update.estimate
        if self._free:
            full[:3] = momentum[:3] / -self._update.mass
        return full, float(full[:3] @ momentum[:3] + full[3:] @ momentum[3:])

    def _desired(self, reference: Reference) -> Motion:
        x, dx = euler_state(reference)
        ddx = euler_acceleration(reference, x, dx)
        if not self.gains.lead:
            return x, dx, ddx
        # The reference is known at its stamp only; half a period on it is extrapolated with the jerk so far.
        half, before = 0.5 * self.control_period, self._last_acceleration
        self._last_acceleration = ddx
        jerk = np.zeros(ddx.size) if before is None else (ddx - before) / self.control_period
        return (
            x + half * (dx + half / 2.0 * (ddx + half / 3.0 * jerk)),
            dx + half * (ddx + half / 2.0 * jerk),
            ddx + half * jerk,
        )

    def _ahead(self, x: Vector, dx: Vector, ddx: Vector) -> tuple[Vector, Vector]:
        """The state half a period on, if it is accelerated as desired."""
        half = 0.5 * self.control_period
        return x + half * (dx + half / 2.0 * ddx), dx + half * ddx

    def _damping_matrix(self, x: Vector) -> Vector:
        matrix = self.regressor.reduced_mass_matrix(x) if self._free else self.regressor.mass_matrix(x)
        lowest = float(np.linalg.eigvalsh(matrix)[0])
        if not lowest > 0.0:
            raise ControlError(
                "the mass matrix of the nominal model is not positive definite",
                key="K_D",
                value=lowest,
                accepted="eigenvalues > 0: a prior nearer to a robot that can exist",
            )
        return self.gains.kappa * matrix

    def _check_pitch(self, x: Vector) -> None:
        pitch = float(x[PITCH])
        if abs(pitch) > self._pitch_limit:
            limit = self.gains.pitch_limit_deg
            raise ControlError(
                "the base is near the singularity of Euler angles",
                key="pitch",
                value=f"{degrees(pitch):.6g} deg (cos {cos(pitch):.3g})",
                accepted=f"-{limit:g} to {limit:g} deg; ntsmc and computed_torque have no such limit",
            )

    def _in_body(self, x: Vector, generalised: Vector) -> Vector:
        u = np.array(generalised)
        u[3:6] = body_torque(x, generalised[3:6].tolist())
        u[:3] = 0.0 if self._free else rotate_inverse(from_rpy(x[[ROLL, PITCH, YAW]]), generalised[:3])
        return u

    def _error_blocks(self, error: Vector, sigma: Vector) -> dict[str, Vector]:
        turn = slice(3 - self._first, 6 - self._first)
        shown = np.array(sigma)
        shown[turn] = sigma[turn][::-1]
        blocks = {"euler_error": error[turn][::-1], "joint_error": error[turn.stop :], "sliding_variable": shown}
        return blocks if self._free else {"position_error": error[:3], **blocks}
