"""The compiled cycle of the adaptive law for one robot and one set of gains, behind values of the data flow."""

from __future__ import annotations

import numpy as np

from space_robot_control.kernel.limits import fits
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.consistency import judge
from space_robot_control.laws.adaptive.kernel.control import answer
from space_robot_control.laws.adaptive.kernel.euler import coordinates
from space_robot_control.laws.adaptive.kernel.least_squares import combine, learn, spread
from space_robot_control.laws.adaptive.kernel.regression import middle
from space_robot_control.laws.adaptive.kernel.tree import tree_of
from space_robot_control.laws.adaptive.kernel.workspace import ACCELEROMETER, MODEL, VELOCITY, Held, Rule, desk_for
from space_robot_description.kernel.jit import bound, ready
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

_SOURCES = {"model": MODEL, "accelerometer": ACCELEROMETER, "velocity": VELOCITY}


class Cycle:
    """Holds the numbers that the kernels work on; compiled when it is made, the first time on a machine.

    Args:
        robot: the NOMINAL robot.
        gains: of the law.
        control_period: [s].

    Attributes:
        rule: the law in numbers; ``damping`` is the caller's to fill.
        desk: what the last call left.
        shown: (m,) where telemetry finds translation, roll, pitch, yaw and joints in an array of the actuated.
    """

    def __init__(self, robot: Robot, gains: AdaptiveGains, control_period: float) -> None:
        n, free = robot.n, robot.base_mode == "free_floating"
        first = 3 if free else 0
        noise = np.array([*[gains.rls.force_noise] * 3, *[gains.rls.torque_noise] * (3 + n)])[first:]
        self._tree, size = tree_of(robot.model), 6 + n - first
        self.rule = Rule(
            first=first,
            period=control_period,
            half=0.5 * control_period if gains.lead else 0.0,
            on_velocity=int(gains.lambda_on == "velocity"),
            weight=gains.lambda_.values(robot, "controller.gains.lambda")[first:].copy(),
            damping=np.zeros((size, size)),
            source=_SOURCES[gains.rls.translation] if free else VELOCITY,
            noise=noise,
        )
        self.desk = desk_for(n, first)
        # Of the rotations telemetry shows roll first, the coordinates have yaw first.
        self.shown = np.array([0, 1, 2, 5, 4, 3, *range(6, 6 + n)])[first:] - first
        self._values = np.zeros(6 + n)
        self._lesson = self.desk.rows[first:], self._values[first:]
        self._compile(n)

    def reset(self) -> None:
        """Forget the reference before."""
        self.desk.before[:] = 0.0

    def middle(self, estimate: Vector, held: Held, x: Vector, dx: Vector, state: RobotState) -> tuple[Vector, Vector]:
        """Return regressor (m, P) and generalised force (m,) in the middle of a period, scaled to unit noise.

        Both are memory that the next call writes anew.

        Args:
            estimate: (P,) pi_hat.
            held: start of the period.
            x: (6+n,) Euler coordinates at its end.
            dx: (6+n,) their rates at its end.
            state: at its end.
        """
        measured = state.q, state.v, state.effort, state.base_acceleration
        self._middle(self._tree, self.rule, estimate, held, x, dx, *measured, self.desk, self._values)
        return self._lesson

    def answer(
        self, estimate: Vector, x: Vector, dx: Vector, omega: Vector, wheels: Vector, reference: Reference
    ) -> tuple[Vector, float]:
        """Return the command u (6+n,) and the Lyapunov function [J]; the rest is on the desk.

        Args:
            estimate: (P,) pi_hat.
            x: (6+n,) Euler coordinates of the state.
            dx: (6+n,) their rates.
            omega: (3,) body rate [rad/s].
            wheels: (3,) momentum of the wheels, body frame [N m s].
            reference: of the same stamp.
        """
        u = np.empty(x.size)
        asked = reference.q, reference.v, reference.a
        value = self._answer(self._tree, self.rule, estimate, x, dx, omega, wheels, *asked, self.desk, u)
        return u, value

    def _compile(self, n: int) -> None:
        """Get the machine code for what every call brings: read-only values of the data flow, memory of our own."""
        q, v = np.zeros(7 + n), np.zeros(6 + n)
        state, asked = RobotState(0, q, v, np.zeros(n), np.zeros(3)), Reference(0, q, v, v)
        estimate, omega, wheels = np.zeros(10 * (1 + n)), state.v[3:6], np.zeros(3)
        held = Held(v, v, omega, wheels, v[:6])
        measured = state.q, state.v, state.effort, state.base_acceleration
        self._middle = bound(middle, self._tree, self.rule, estimate, held, v, v, *measured, self.desk, v)
        self._answer = bound(
            answer, self._tree, self.rule, estimate, v, v, omega, wheels, asked.q, asked.v, asked.a, self.desk, v
        )
        rows, values = self._lesson
        ready(coordinates, state.q, state.v, v, v)
        root, pair = np.zeros((estimate.size, estimate.size)), np.zeros((2, estimate.size))
        ready(learn, rows, values, root, estimate, values, pair)
        ready(spread, root, estimate, estimate, estimate)
        ready(combine, self.desk.rows, v, estimate)
        ready(judge, estimate)
        ready(fits, np.zeros((3, 3)), np.zeros(3), np.zeros(3), v[:6])
