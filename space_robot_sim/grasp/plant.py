"""What every robot with a second body in its grasp does as a plant: delay and hold, integration, balance, telemetry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque

import numpy as np

from space_robot_description.actuation import command_limit
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import IntegrationError, SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Command, PlantSample, RobotState, Vector
from space_robot_msgs_py.kernel.products import norm as length_of
from space_robot_sim.command_hold import Acting, CommandHold
from space_robot_sim.command_monitor import CommandMonitor
from space_robot_sim.grasp.conservation import ConservationBalance
from space_robot_sim.grasp.dynamics import GraspDynamics, Push
from space_robot_sim.grasp.law import Grasp
from space_robot_sim.grasp.orbit import Orbit
from space_robot_sim.grasp.spec import GraspSpec
from space_robot_sim.grasp.telemetry import GraspTelemetry
from space_robot_sim.initial import RunConditions


class GraspedBody(ABC):
    """A robot whose grasp gives way; subclasses say what the actuators make of a command and what is seen.

    Args:
        robot: the truth.
        grasp: the spec of its grasp.
        limit: (6+n,) of a command; 0 where it does nothing.
        lag: of the wheels [s].
        orbit: moves the frame of the state; None: free space.
        step: of the integration [s].
        seen: how many integration steps old configurations are kept for the sensors.
        conditions: of the run.

    Attributes:
        dynamics: its equations of motion.

    Raises:
        SpecError: an argument does not fit the robot or the period.
    """

    def __init__(
        self,
        robot: Robot,
        grasp: GraspSpec,
        *,
        limit: Vector,
        lag: float,
        orbit: Orbit | None,
        step: float,
        seen: int,
        conditions: RunConditions,
    ) -> None:
        initial, control_period = conditions.initial, conditions.control_period
        if initial.q.size != 7 + robot.n:
            raise SpecError("wrong size", key="initial.q", value=initial.q.size, accepted=f"{7 + robot.n} numbers")
        joints, force = grasp_joints(robot, grasp), Grasp(grasp)
        self._n, self._initial, self._limit, self._lag = robot.n, initial, limit, lag
        self._steps = whole_steps(control_period, step, "control_period")
        self._period, self._h = control_period, control_period / NANOSECONDS / self._steps
        self._hold = CommandHold(robot.n, delay_periods=conditions.delay_periods, hold=conditions.hold)
        self._monitor = CommandMonitor(conditions.monitor, command_limit(robot), robot.joint_names)
        self.dynamics = GraspDynamics(robot, force, joints, lag, orbit)
        self._conservation, self._telemetry = ConservationBalance(robot.model), GraspTelemetry(robot, joints, force)
        self._seen: deque[Vector] = deque(maxlen=seen + 1)

    @abstractmethod
    def _push(self, acting: Vector) -> Push:
        """What the actuators make of a command (6+n,) in the period that begins."""

    @abstractmethod
    def _see(self, push: Push) -> RobotState:
        """What is measured at this stamp, after a period under a push."""

    @abstractmethod
    def _forget(self) -> None:
        """Restart the sensors."""

    def reset(self) -> PlantSample:
        """Return to the initial state and show it (stamp 0)."""
        self._y = np.zeros(self.dynamics.size)
        self._y[: 13 + 2 * self._n] = np.concatenate([self._initial.q, self._initial.v])
        self._stamp = 0
        nothing = self._hold.reset()
        self._monitor.reset()
        self._forget()
        self._conservation.reset()
        self._seen.clear()
        self._seen.append(self._y[: 7 + self._n].copy())
        return self._show(nothing, Push.none(self._n), np.zeros(3), 0.0)

    def step(self, command: Command | None) -> PlantSample:
        """Advance one control period under the command (None: the hold) and show the state at its end.

        Raises:
            CommandError: the command is not for this many joints.
            IntegrationError: the state stopped being finite.
        """
        acting = self._hold.take(self._monitor.check(command))
        push, stored = self._push(acting.u), self._y[self.dynamics.wheels].copy()
        if self._lag == 0.0:
            self._y[self.dynamics.wheel_torque] = push.torque
        with np.errstate(over="ignore", invalid="ignore"):
            for index in range(self._steps):
                self._y = self.dynamics.step(self._y, push, self._stamp / NANOSECONDS + index * self._h, self._h)
                self._seen.append(self._y[: 7 + self._n].copy())
        self._stamp += self._period
        if not np.isfinite(self._y).all():
            raise IntegrationError(f"not finite at {self._stamp / NANOSECONDS:g} s", key="state")
        norm = length_of(self._y[3:7])
        self._y[3:7] /= norm
        wheels = (stored - self._y[self.dynamics.wheels]) / (self._steps * self._h)
        return self._show(acting, push, wheels, abs(norm - 1.0))

    def _show(self, acting: Acting, push: Push, wheels: Vector, quaternion_residual: float) -> PlantSample:
        n, layout, y = self._n, self.dynamics, self._y
        telemetry = self._telemetry.of(
            self._stamp,
            motion=y[: 13 + 2 * n],
            grasp=(float(y[layout.bristle]), push.rest, push.turning),
            wheels=y[layout.wheels],
            balance=self._conservation.balance(y[: 13 + 2 * n], y[layout.wheels], y[layout.balance]),
            quaternion_residual=quaternion_residual,
            applied=np.concatenate([push.force, wheels + push.moment, push.effort]),
            acting=acting,
            limit=self._limit,
        )
        return PlantSample(self._see(push), telemetry, events=self._monitor.events(self._stamp))


def grasp_joints(robot: Robot, spec: GraspSpec) -> tuple[int, int, int]:
    """Indices of the grasp's joints in the robot.

    Raises:
        SpecError: no such joint, or of the wrong kind, or one follows another, or the base cannot be pushed.
    """
    if robot.base_mode != "free_flying":
        raise SpecError("cannot be pushed", key="robot.base_mode", value=robot.base_mode, accepted="free_flying")
    if robot.mimics:
        follower = next(iter(robot.mimics))
        raise SpecError("mimics another joint", key=f"joint {follower}", accepted="plant.kind: articulated")
    for name, length in zip(spec.joints, (True, True, False), strict=True):
        if name not in robot.joint_names:
            accepted = ", ".join(robot.joint_names)
            raise SpecError("no such joint", key="plant.grasp.joints", value=name, accepted=accepted)
        if robot.prismatic[robot.joint_names.index(name)] != length:
            accepted = "two prismatic joints, then a revolute one"
            raise SpecError("wrong kind of joint", key="plant.grasp.joints", value=name, accepted=accepted)
    first, second, third = (robot.joint_names.index(name) for name in spec.joints)
    return first, second, third


def whole_steps(span: int, step: float, key: str) -> int:
    """Number of integration steps [s] in a span [ns].

    Raises:
        SpecError: it is not a whole number.
    """
    length = round(step * NANOSECONDS)
    if length == 0 or span % length:
        accepted = f"a multiple of plant.step, {step:g} s"
        raise SpecError("does not divide into steps", key=key, value=span / NANOSECONDS, accepted=accepted)
    return span // length
