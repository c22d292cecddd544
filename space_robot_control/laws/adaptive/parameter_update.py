"""The estimate of the inertial parameters and what moves it: RLS on the last period, Lyapunov's update, or both."""

from __future__ import annotations

from math import inf

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.adaptive.consistency import natural_step, project
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.consistency import judge
from space_robot_control.laws.adaptive.kernel.least_squares import combine
from space_robot_control.laws.adaptive.kernel.workspace import Held
from space_robot_control.laws.adaptive.least_squares import RecursiveLeastSquares
from space_robot_control.laws.base import Blocks
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import RobotState, Vector


class ParameterUpdate:
    """pi_hat of one run, starting at the nominal parameters, or with ``consistency`` at the nearest that can exist.

    RLS takes one row per actuated degree of freedom and period: state at the middle of the period, x'' from differenced
    rates, effort as measured, base torque as commanded. A period whose base command is beyond the nominal actuators is
    left out, because nobody measured what acted.

    Args:
        robot: the NOMINAL robot.
        prior: (10 (1+n),) its parameters.
        cycle: the regressor of a period.
        gains: of the law.

    Attributes:
        estimate: (10 (1+n),) pi_hat; a new array after every update.
        consistent: every body with these parameters can exist.

    Reference: Liu, Teng, Jin (2023), (39)-(45).
    """

    def __init__(self, robot: Robot, prior: Vector, cycle: Cycle, gains: AdaptiveGains) -> None:
        self._cycle, self._gains = cycle, gains
        self._limits = CommandLimits(robot)
        size, rls = np.abs(prior), gains.rls
        self._noise = cycle.rule.noise
        self._innovation = np.zeros(self._noise.size)
        self._learned = False
        self._rls: RecursiveLeastSquares | None = None
        if gains.update in ("rls", "composite"):
            when = rls.reset
            limits = (inf, 1) if when is None else (when.threshold, when.samples)
            self._rls = RecursiveLeastSquares(rls.prior_spread * size + rls.prior_floor, *limits)
        self._tracks = gains.update in ("lyapunov", "composite")
        self._step = cycle.rule.period * gains.tracking.gain
        self._gain = self._step * (size + gains.tracking.floor) ** 2
        self._held: Held | None = None
        self.estimate: Vector = np.array(prior if gains.consistency == "none" else project(prior))
        _, _, self.consistent = judge(self.estimate)

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
        if not self._limits.base_fits(held.wrench):
            self._innovation = np.zeros(self._noise.size)
            return
        rows, values = self._cycle.middle(self.estimate, held, x, dx, state)
        estimate, innovation = self._rls.correct(self.estimate, rows, values)
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
        gradient = np.empty(self.estimate.size)
        combine(regressor, sigma, gradient)
        if self._gains.consistency == "natural":
            self._accept(natural_step(self.estimate, gradient, self._step))
        elif self._rls is not None:
            self._accept(self.estimate + self._step * self._rls.spread_along(gradient))
        else:
            self._accept(self.estimate + self._gain * gradient)

    def hold(self, held: Held) -> None:
        """Remember what the next period starts with."""
        self._held = held

    def pause(self) -> None:
        """Others command for a while: nothing is learned from the period that is under way."""
        self._held = None

    def blocks(self) -> Blocks:
        """Telemetry of the update; the labels depend on the gains only."""
        out: dict[str, Vector | float] = {"parameters": self.estimate, "consistent": float(self.consistent)}
        if self._rls is not None:
            out["innovation"] = self._innovation[self._cycle.shown]
            out["surprise"] = self._rls.surprise
            out["covariance_trace"] = self._rls.covariance_trace
            out["resets"] = float(self._rls.resets)
            out["learned"] = float(self._learned)
        return out

    def health(self) -> dict[str, float]:
        """See ``Law.health``."""
        out = {"consistent": float(self.consistent)}
        if self._rls is not None:
            out["covariance_condition"] = self._rls.condition
            out["covariance_trace"] = float(self._rls.covariance_trace)
            out["resets"] = float(self._rls.resets)
        return out

    def _accept(self, estimate: Vector) -> None:
        finite, mass, possible = judge(estimate)
        if not finite:
            raise ControlError("the parameter estimate is not finite", key="parameters", accepted="finite numbers")
        if self._gains.consistency == "project" and not possible:
            estimate = project(estimate)
            _, mass, possible = judge(estimate)
        self.estimate, self.consistent = estimate, possible
        if mass <= 0.0:
            raise ControlError(
                "the estimated mass is no longer positive",
                key="parameters (total mass)",
                value=float(mass),
                accepted="> 0 kg",
            )
