"""The compiled cycle of the adaptive law for one robot and one set of gains, behind values of the data flow."""

from __future__ import annotations

import numpy as np

from space_robot_control.kernel.limits import fits
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.consistency import assess
from space_robot_control.laws.adaptive.kernel.control import control
from space_robot_control.laws.adaptive.kernel.euler import coordinates
from space_robot_control.laws.adaptive.kernel.least_squares import correct, covariance_times, transpose_times
from space_robot_control.laws.adaptive.kernel.regression import regression
from space_robot_control.laws.adaptive.kernel.regressor import slotine_li
from space_robot_control.laws.adaptive.kernel.tree import tree_of
from space_robot_control.laws.adaptive.kernel.workspace import (
    ACCELEROMETER,
    MODEL,
    VELOCITY,
    PeriodStart,
    Rule,
    workspace_for,
)
from space_robot_description.kernel.jit import bound, ready
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from space_robot_msgs_py.kernel.products import times

_SOURCES = {"model": MODEL, "accelerometer": ACCELEROMETER, "velocity": VELOCITY}


class Cycle:
    """The arrays that the kernels work on; compiled when it is made, the first time on a machine.

    Args:
        robot: the NOMINAL robot.
        gains: of the law.
        control_period: [s].

    Attributes:
        tree: geometry of the robot.
        rule: the gains; ``k_d`` is the caller's to fill.
        workspace: results of the last call.
        order: (m,) where telemetry finds translation, roll, pitch, yaw and joints in an array of the actuated.
    """

    def __init__(self, robot: Robot, gains: AdaptiveGains, control_period: float) -> None:
        n, free = robot.n, robot.base_mode == "free_floating"
        first = 3 if free else 0
        noise = np.array([*[gains.rls.force_noise] * 3, *[gains.rls.torque_noise] * (3 + n)])[first:]
        self.tree, size = tree_of(robot.model), 6 + n - first
        self.rule = Rule(
            first=first,
            period=control_period,
            ahead=(0.5 + robot.command_delay) * control_period if gains.lead else 0.0,
            on_velocity=int(gains.lambda_on == "velocity"),
            lambda_=gains.lambda_.values(robot, "controller.gains.lambda")[first:].copy(),
            k_d=np.zeros((size, size)),
            source=_SOURCES[gains.rls.translation] if free else VELOCITY,
            noise=noise,
        )
        self.workspace = workspace_for(n, first, len(robot.mimics))
        # Of the rotations telemetry has roll first, the coordinates have yaw first.
        self.order = np.array([0, 1, 2, 5, 4, 3, *range(6, 6 + n)])[first:] - first
        self._tau = np.zeros(6 + n)
        self._rows = self.workspace.Y[first:], self._tau[first:]
        self._compile(n)

    def reset(self) -> None:
        """Forget the last reference."""
        self.workspace.ddx_d_before[:] = 0.0

    def mass_matrix(self, x: Vector, parameters: Vector) -> Vector:
        """Return the symmetric M (m, m) of a robot of parameters pi (P,), the translation eliminated if it is free.

        Args:
            x: (6+n,) Euler coordinates [m, rad].
            parameters: pi.
        """
        first, work, rows = self.rule.first, self.workspace, []
        for unit in np.identity(x.size)[first:]:
            slotine_li(self.tree, work.places, x, work.zero, work.zero, unit, parameters, bool(first), work.Y)
            rows.append(times(work.Y[first:], parameters))
        lower = np.tril(rows)
        out: Vector = lower + np.tril(lower, -1).T
        return out

    def regression(
        self, pi_hat: Vector, start: PeriodStart, x: Vector, dx: Vector, state: RobotState
    ) -> tuple[Vector, Vector]:
        """Return Y (m, P) and generalised force tau (m,) in the middle of a period, scaled to unit noise.

        The next call overwrites both.

        Args:
            pi_hat: (P,) estimate.
            start: of the period.
            x: (6+n,) Euler coordinates at its end.
            dx: (6+n,) their rates at its end.
            state: at its end.
        """
        measured = state.q, state.v, state.effort, state.base_acceleration
        self._regression(self.tree, self.rule, pi_hat, start, x, dx, *measured, self.workspace, self._tau)
        return self._rows

    def control(
        self, pi_hat: Vector, x: Vector, dx: Vector, omega: Vector, wheels: Vector, reference: Reference
    ) -> tuple[Vector, float]:
        """Return the command u (6+n,) and the Lyapunov function [J]; errors and Y are in ``workspace``.

        Args:
            pi_hat: (P,) estimate.
            x: (6+n,) Euler coordinates of the state.
            dx: (6+n,) their rates.
            omega: (3,) body rate [rad/s].
            wheels: (3,) momentum of the wheels, body frame [N m s].
            reference: of the same stamp.
        """
        u = np.empty(x.size)
        desired = reference.q, reference.v, reference.a
        value = self._control(self.tree, self.rule, pi_hat, x, dx, omega, wheels, *desired, self.workspace, u)
        return u, value

    def _compile(self, n: int) -> None:
        """Get the machine code for the types of every call: read-only values of the data flow, own memory."""
        q, v = np.zeros(7 + n), np.zeros(6 + n)
        state, desired = RobotState(0, q, v, np.zeros(n), np.zeros(3)), Reference(0, q, v, v)
        pi_hat, omega, wheels = np.zeros(self.workspace.Y.shape[1]), state.v[3:6], np.zeros(3)
        start = PeriodStart(v, v, omega, wheels, v[:6])
        measured = state.q, state.v, state.effort, state.base_acceleration
        self._regression = bound(regression, self.tree, self.rule, pi_hat, start, v, v, *measured, self.workspace, v)
        target = desired.q, desired.v, desired.a
        self._control = bound(control, self.tree, self.rule, pi_hat, v, v, omega, wheels, *target, self.workspace, v)
        rows, tau = self._rows
        ready(coordinates, state.q, state.v, v, v)
        root, pair = np.zeros((pi_hat.size, pi_hat.size)), np.zeros((2, pi_hat.size))
        ready(correct, rows, tau, root, pi_hat, tau, pair)
        ready(covariance_times, root, pi_hat, pi_hat, pi_hat)
        ready(transpose_times, self.workspace.Y, v, pi_hat)
        ready(assess, pi_hat)
        ready(fits, np.zeros((3, 3)), np.zeros(3), np.zeros(3), v[:6])
