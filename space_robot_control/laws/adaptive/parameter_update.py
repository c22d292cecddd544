"""The estimate of the inertial parameters and its update: RLS on the last period, the Lyapunov update, or both."""

from __future__ import annotations

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.adaptive.consistency import natural_step, project
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.filtered_regression import FilteredRegression
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.consistency import assess
from space_robot_control.laws.adaptive.kernel.least_squares import transpose_times
from space_robot_control.laws.adaptive.kernel.workspace import PeriodStart
from space_robot_control.laws.adaptive.least_squares import RecursiveLeastSquares
from space_robot_control.laws.adaptive.update_rule import update_rule
from space_robot_control.laws.base import Blocks
from space_robot_control.nominal_friction import NominalFriction
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import RobotState, Vector


class ParameterUpdate:
    """pi_hat of one run, starting at the nominal parameters, or with ``consistency`` at the nearest that can exist.

    RLS takes one row per actuated degree of freedom and period: state at the middle of the period, x'' from differenced
    rates, effort as measured less the friction that is known, base torque by the readings of the wheels, or as
    commanded where there are none. A period whose base command is beyond the nominal actuators is left out, because
    what acted is not known; of wheels that are measured it is, and saturated periods teach as others do.

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
        self._limits, self._friction = CommandLimits(robot), NominalFriction(robot, known=robot.knows_friction)
        rule = update_rule(gains, cycle.rule.period, prior)
        self._noise = cycle.rule.noise
        self._innovation = np.zeros(self._noise.size)
        self._learned = False
        self._rls: RecursiveLeastSquares | None = None
        if rule.squares:
            self._rls = RecursiveLeastSquares(rule.spread, rule.threshold, rule.samples)
        self._filter = FilteredRegression(gains.rls.bandwidth * cycle.rule.period) if rule.filtered else None
        self._tracks, self._step, self._gain = bool(rule.tracks), rule.step, rule.gain
        self._start: PeriodStart | None = None
        self.estimate: Vector = np.array(prior if gains.consistency == "none" else project(prior))
        _, _, self.consistent = assess(self.estimate)

    def observe(self, state: RobotState, x: Vector, dx: Vector, wheels: tuple[Vector, Vector] | None = None) -> None:
        """RLS (39)-(41) on the period that ended in this state.

        Args:
            state: as measured.
            x: (6+n,) its Euler coordinates.
            dx: (6+n,) their rates.
            wheels: ``WheelMomentum.measured`` of the period; None: it is not.

        Raises:
            ControlError: the estimate is unusable: not finite, without mass, covariance blown up.
        """
        self._learned = False
        start = self._start
        if self._rls is None or start is None:
            return
        unknown = start.wrench
        if wheels is not None:
            middle, torque = wheels
            start = start._replace(wheels=middle, wrench=np.concatenate((start.wrench[:3], torque)))
            # At its limit a torque that was read is as often beyond it as within: what acted is known all the same.
            unknown = np.concatenate((start.wrench[:3], np.zeros(3)))
        if not self._limits.base_fits(unknown):
            self._innovation = np.zeros(self._noise.size)
            return
        acting = self._friction.without(state, start.dx[6:])
        Y, tau = self._cycle.regression(self.estimate, start, x, dx, acting)
        if self._filter is not None:
            Y, tau = self._filter.update(Y, tau)
        estimate, innovation = self._rls.correct(self.estimate, Y, tau)
        self._innovation, self._learned = innovation * self._noise, True
        self._accept(estimate)

    def track(self, Y: Vector, sigma: Vector) -> None:
        """The Lyapunov update (44): pi_hat' = Gamma Y^T sigma.

        Args:
            Y: (6+n, 10 (1+n)) regressor of the command.
            sigma: (6+n,) sliding variable with eliminated translation.

        Raises:
            ControlError: the estimate is unusable.
        """
        if not self._tracks:
            return
        gradient = np.empty(self.estimate.size)
        transpose_times(Y, sigma, gradient)
        if self._gains.consistency == "natural":
            self._accept(natural_step(self.estimate, gradient, self._step))
        elif self._rls is not None:
            self._accept(self.estimate + self._step * self._rls.covariance_times(gradient))
        else:
            self._accept(self.estimate + self._gain * gradient)

    def begin(self, start: PeriodStart) -> None:
        """Take note of the period that begins."""
        self._start = start

    def pause(self) -> None:
        """Leave out the present period: another law commands."""
        self._start = None

    def blocks(self) -> Blocks:
        """Telemetry of the update; the labels depend on the gains only."""
        out: dict[str, Vector | float] = {"parameters": self.estimate, "consistent": float(self.consistent)}
        if self._rls is not None:
            out["innovation"] = self._innovation[self._cycle.order]
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
        finite, mass, possible = assess(estimate)
        if not finite:
            raise ControlError("the parameter estimate is not finite", key="parameters", accepted="finite numbers")
        if self._gains.consistency == "project" and not possible:
            estimate = project(estimate)
            _, mass, possible = assess(estimate)
        self.estimate, self.consistent = estimate, possible
        if mass <= 0.0:
            raise ControlError(
                "the estimated mass is no longer positive",
                key="parameters (total mass)",
                value=float(mass),
                accepted="> 0 kg",
            )
