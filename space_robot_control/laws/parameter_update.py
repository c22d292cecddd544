"""The estimate of the inertial parameters and what moves it: RLS on the last period, Lyapunov's update, or both."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite

import numpy as np

from space_robot_control.euler import PITCH, ROLL, YAW, difference, generalised_torque
from space_robot_control.laws.adaptive_gains import AdaptiveGains
from space_robot_control.laws.base import Blocks
from space_robot_control.laws.consistency import is_consistent, natural_step, project
from space_robot_control.laws.least_squares import RecursiveLeastSquares
from space_robot_control.laws.limits import CommandLimits
from space_robot_control.laws.regressor import PER_BODY, Regressor
from space_robot_control.laws.wheels import gyroscopic
from space_robot_control.rotations import from_rpy, rotate
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import RobotState, Vector


@dataclass(frozen=True, eq=False, slots=True)
class Held:
    """What a period starts with and what acts over it.

    Attributes:
        x: (6+n,) Euler coordinates.
        dx: (6+n,) their rates.
        omega: (3,) body rate [rad/s].
        wheels: (3,) momentum of the wheels in the middle of the period, body frame [N m s].
        wrench: (6,) commanded on the base, body frame [N, N m].
    """

    x: Vector
    dx: Vector
    omega: Vector
    wheels: Vector
    wrench: Vector


class ParameterUpdate:
    """pi_hat of one run, starting at the nominal parameters, or with ``consistency`` at the nearest that can exist.

    RLS takes one row per actuated degree of freedom and period: state at the middle of the period, x'' from differenced
    rates, effort as measured, base torque as commanded. A period whose base command is beyond the nominal actuators is
    left out, because nobody measured what acted.

    Args:
        robot: the NOMINAL robot.
        regressor: its linear separation.
        gains: of the law.
        control_period: [s].

    Attributes:
        estimate: (10 (1+n),) pi_hat.

    Reference: Liu, Teng, Jin (2023), (39)-(45).
    """

    def __init__(self, robot: Robot, regressor: Regressor, gains: AdaptiveGains, control_period: float) -> None:
        self._regressor, self._gains, self._period = regressor, gains, control_period
        self._first = 3 if robot.base_mode == "free_floating" else 0
        self._limits = CommandLimits(robot)
        self.estimate: Vector = regressor.parameters
        size, rls = np.abs(regressor.parameters), gains.rls
        self._noise = np.full(6 + robot.n - self._first, rls.torque_noise)
        self._noise[: 3 - self._first] = rls.force_noise
        self._innovation = np.zeros(self._noise.size)
        self._learned = False
        self._rls: RecursiveLeastSquares | None = None
        if gains.update in ("rls", "composite"):
            when = rls.reset
            limits = (inf, 1) if when is None else (when.threshold, when.samples)
            self._rls = RecursiveLeastSquares(rls.prior_spread * size + rls.prior_floor, *limits)
        self._tracks = gains.update in ("lyapunov", "composite")
        self._step = control_period * gains.tracking.gain
        self._scale = (size + gains.tracking.floor) ** 2
        self._held: Held | None = None
        if gains.consistency != "none":
            self.estimate = project(self.estimate)
        self.consistent = is_consistent(self.estimate)

    @property
    def mass(self) -> float:
        """Estimated mass of the whole robot [kg]."""
        return float(self.estimate[::PER_BODY].sum())

    def observe(self, state: RobotState, x: Vector, dx: Vector) -> None:
        """Learn from the period that ended in this state.

        Args:
            state: as measured.
            x: (6+n,) its Euler coordinates.
            dx: (6+n,) their rates.

        Raises:
            ControlError: the estimate is lost: not finite, no mass left, covariance blown up.
        """
        self._learned = False
        held = self._held
        if self._rls is None or held is None:
            return
        self._innovation = np.zeros(self._noise.size)
        # The joints' efforts are measured; only what the base was told has to be believed.
        if self._limits.fits(np.concatenate((held.wrench, np.zeros(state.effort.size)))):
            rows, values = self._rows(held, state, x, dx)
            estimate, innovation = self._rls.correct(self.estimate, rows / self._noise[:, None], values / self._noise)
            self._innovation, self._learned = innovation * self._noise, True
            self._accept(estimate)

    def track(self, regressor: Vector, sigma: Vector) -> None:
        """Learn from the tracking error by (44): pi_hat' = Gamma Y^T sigma.

        Args:
            regressor: (6+n, 10 (1+n)) Y of the command.
            sigma: (6+n,) sliding variable with the translation it entails.

        Raises:
            ControlError: the estimate is lost.
        """
        if not self._tracks:
            return
        gradient = sigma @ regressor
        if self._gains.consistency == "natural":
            self._accept(natural_step(self.estimate, gradient, self._step))
        elif self._rls is not None:
            self._accept(self.estimate + self._step * self._rls.spread_along(gradient))
        else:
            self._accept(self.estimate + self._step * self._scale * gradient)

    def hold(self, held: Held) -> None:
        """Remember what the next period starts with."""
        self._held = held

    def blocks(self) -> Blocks:
        """Telemetry of the update; the labels depend on the gains only."""
        out: dict[str, object] = {"parameters": self.estimate, "consistent": float(self.consistent)}
        if self._rls is not None:
            out |= {
                "innovation": self._by_roll_pitch_yaw(self._innovation),
                "surprise": self._rls.surprise,
                "covariance_trace": self._rls.covariance_trace,
                "resets": float(self._rls.resets),
                "learned": float(self._learned),
            }
        return out  # type: ignore[return-value]

    def _rows(self, held: Held, state: RobotState, x1: Vector, dx1: Vector) -> tuple[Vector, Vector]:
        """Regressor (m, P) and generalised force (m,) in the middle of the period."""
        x, dx = held.x + 0.5 * difference(x1, held.x), 0.5 * (held.dx + dx1)
        ddx = (dx1 - held.dx) / self._period
        acting = held.wrench[3:] - gyroscopic(0.5 * (held.omega + state.v[3:6]), held.wheels)
        torque = generalised_torque(x, acting.tolist())
        if self._first == 0:
            force = rotate(from_rpy(x[[ROLL, PITCH, YAW]]), held.wrench[:3])
            return self._regressor.inverse_dynamics(x, dx, ddx), np.array((*force, *torque, *state.effort.tolist()))
        source = self._gains.rls.translation
        if source == "accelerometer":
            ddx[:3] = rotate(state.q[3:7], state.base_acceleration)
        elif source == "model":
            ddx[:3] = 0.0
        rows = self._regressor.inverse_dynamics(x, dx, ddx)
        if source == "model":
            push = np.zeros(ddx.size)
            push[:3] = rows[:3] @ self.estimate / -self.mass
            rows += self._regressor.inertia(x, push)
        return rows[3:], np.array((*torque, *state.effort.tolist()))

    def _accept(self, estimate: Vector) -> None:
        if not isfinite(estimate.sum()):
            raise ControlError("the parameter estimate is not finite", key="parameters", accepted="finite numbers")
        if self._gains.consistency == "project":
            estimate = project(estimate)
        self.estimate = estimate
        if self.mass <= 0.0:
            raise ControlError(
                "the estimated mass is no longer positive",
                key="parameters (total mass)",
                value=self.mass,
                accepted="> 0 kg",
            )
        self.consistent = is_consistent(estimate)

    def _by_roll_pitch_yaw(self, values: Vector) -> Vector:
        out = np.array(values)
        first = 3 - self._first
        out[first : first + 3] = values[first : first + 3][::-1]
        return out
