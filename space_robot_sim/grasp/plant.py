"""The air-bearing testbed behind the Plant protocol: a base with flywheel and thrusters that holds a second body."""

from __future__ import annotations

from collections import deque
from math import cos, pi, sin
from typing import Literal

import numpy as np

from space_robot_description.report import torque_capacity
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import CommandError, IntegrationError, SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Command, PlantSample, Vector
from space_robot_sim.grasp.books import Books
from space_robot_sim.grasp.camera import Camera
from space_robot_sim.grasp.dynamics import GraspDynamics, Push
from space_robot_sim.grasp.law import Grasp
from space_robot_sim.grasp.spec import AirbearingSpec
from space_robot_sim.grasp.telemetry import GraspTelemetry
from space_robot_sim.initial import InitialState

FORWARD, SIDEWAYS, YAW = 0, 1, 5


class AirbearingTestbed:
    """Two bodies that glide on a table: x, y and yaw of the base are pushed, everything else carries or gives way.

    The base is pushed by thrusters (their line of action misses the origin) and by a flywheel with lag; the robot's
    three joints named in the spec are the grasp. Commands out of the plane and to the grasp do nothing and show in
    ``command_ignored``. The state is what the cameras read.

    Args:
        robot: the truth: masses, inertias, where the grasp is, limits of thrusters and wheels.
        spec: the rest of the testbed.
        control_period: [ns].
        initial: where a run starts, in the plane.
        seed: of cameras and disturbance.
        delay_periods: 1: the command that answers state k acts from state k+1 on, and nothing does before.
        hold: what acts in place of a missing command: nothing, or the last one.

    Raises:
        SpecError: an argument does not fit the robot, the plane or the period.
    """

    def __init__(
        self,
        robot: Robot,
        spec: AirbearingSpec,
        *,
        control_period: int,
        initial: InitialState,
        seed: int = 0,
        delay_periods: Literal[0, 1] = 0,
        hold: Literal["zero", "last"] = "zero",
    ) -> None:
        joints = grasp_joints(robot, spec)
        self._steps, late = substeps(spec, control_period)
        _check_planar(initial, robot)
        self._spec, self._initial, self._n = spec, initial, robot.n
        self._period, self._h = control_period, control_period / NANOSECONDS / self._steps
        self._delay, self._hold_last = delay_periods, hold == "last"
        self._dynamics = GraspDynamics(robot, Grasp(spec.grasp), joints, spec.flywheel.lag)
        self._limit, self._full = plane_limits(robot)
        self._books, self._telemetry = Books(robot.model), GraspTelemetry(robot, joints, Grasp(spec.grasp))
        camera_seed, push_seed = np.random.SeedSequence(seed).spawn(2)
        lengths = np.array([index != joints[2] for index in range(robot.n)])
        self._camera = Camera(spec.camera, lengths, control_period, int(camera_seed.generate_state(1, np.uint64)[0]))
        self._outside = _disturbance(spec, np.random.default_rng(push_seed))
        self._seen: deque[Vector] = deque(maxlen=late + 1)
        self.reset()

    def reset(self) -> PlantSample:
        """Return to the initial state and show it (stamp 0)."""
        self._y = np.zeros(self._dynamics.size)
        self._y[: 13 + 2 * self._n] = np.concatenate([self._initial.q, self._initial.v])
        self._stamp = 0
        self._held = self._waiting = np.zeros(6 + self._n)
        self._camera.reset()
        self._books.reset()
        self._seen.clear()
        self._seen.append(self._y[: 7 + self._n].copy())
        return self._show(self._held, np.zeros(6), 0.0)

    def step(self, command: Command | None) -> PlantSample:
        """Advance one control period under the command (None: the hold) and show the state at its end.

        Raises:
            CommandError: the command is not for this many joints.
            IntegrationError: the state stopped being finite.
        """
        acting = self._accept(command)
        if self._delay:
            acting, self._waiting = self._waiting, acting
        push, stored = self._push(acting), self._y[self._dynamics.wheels].copy()
        if self._spec.flywheel.lag == 0.0:
            self._y[self._dynamics.wheel_torque] = push.torque
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(self._steps):
                self._y = self._dynamics.step(self._y, push, self._h)
                self._seen.append(self._y[: 7 + self._n].copy())
        self._stamp += self._period
        if not np.isfinite(self._y).all():
            raise IntegrationError(f"not finite at {self._stamp / NANOSECONDS:g} s", key="state")
        norm = float(np.linalg.norm(self._y[3:7]))
        self._y[3:7] /= norm
        torque = (stored - self._y[self._dynamics.wheels]) / (self._steps * self._h)
        return self._show(acting, np.concatenate([push.force, torque]), abs(norm - 1.0))

    def _accept(self, command: Command | None) -> Vector:
        if command is None:
            return self._held if self._hold_last else np.zeros(6 + self._n)
        if command.effort.size != self._n:
            raise CommandError("wrong size", key="command.effort", value=command.effort.size, accepted=f"{self._n}")
        self._held = command.u
        return self._held

    def _push(self, acting: Vector) -> Push:
        """What the actuators make of a command."""
        allowed = np.clip(acting[:6], -self._limit, self._limit)
        fx, fy, torque = float(allowed[FORWARD]), float(allowed[SIDEWAYS]), float(allowed[YAW])
        # A flywheel that is full takes no more: its momentum grows against the torque on the base.
        wheel = float(self._y[self._dynamics.wheels][2])
        if abs(wheel) >= self._full and wheel * torque < 0.0:
            torque = 0.0
        outside = self._outside
        return Push(
            force=(fx, fy, 0.0),
            moment=(0.0, 0.0, -self._spec.thruster_offset * fx),
            torque=(0.0, 0.0, torque),
            effort=(0.0,) * self._n,
            outside_force=(outside[0], outside[1], 0.0),
            outside_torque=(0.0, 0.0, outside[2]),
        )

    def _show(self, acting: Vector, applied: Vector, quaternion_residual: float) -> PlantSample:
        n, layout, y = self._n, self._dynamics, self._y
        balance = self._books.balance(y[: 7 + n], y[layout.velocity], y[layout.wheels], y[layout.books])
        telemetry = self._telemetry.of(
            self._stamp,
            y[: 13 + 2 * n],
            float(y[layout.bristle]),
            y[layout.wheels],
            balance,
            quaternion_residual,
            applied,
            acting,
            self._limit,
        )
        return PlantSample(self._camera.measure(self._stamp, self._seen[0]), telemetry)


def grasp_joints(robot: Robot, spec: AirbearingSpec) -> tuple[int, int, int]:
    """Indices of the grasp's joints in the robot.

    Raises:
        SpecError: the robot has no such joint, or it is of the wrong kind, or the robot has others.
    """
    kinds = ("P", "P", "R")
    for name, kind in zip(spec.grasp.joints, kinds, strict=True):
        if name not in robot.joint_names:
            accepted = ", ".join(robot.joint_names)
            raise SpecError("no such joint", key="plant.grasp.joints", value=name, accepted=accepted)
        shape = robot.model.joints[robot.joint_names.index(name) + 2].shortname()
        if f"JointModel{kind}" not in shape:
            raise SpecError(
                "wrong kind of joint",
                key=f"plant.grasp.joints ({name})",
                value=shape,
                accepted="two prismatic joints, then a revolute one",
            )
    if robot.n != 3 or robot.base_mode != "free_flying":
        raise SpecError(
            "does not lie on the table",
            key="robot",
            value=f"{robot.n} joints, {robot.base_mode}",
            accepted="a free-flying base and the three joints of the grasp",
        )
    first, second, third = (robot.joint_names.index(name) for name in spec.grasp.joints)
    return first, second, third


def substeps(spec: AirbearingSpec, control_period: int) -> tuple[int, int]:
    """Integration steps in a control period [ns], and in the delay of the cameras.

    Raises:
        SpecError: one of the two is not a whole number of steps.
    """
    step, late = round(spec.step * NANOSECONDS), round(spec.camera.delay * NANOSECONDS)
    for key, value in (("control_period", control_period), ("plant.camera.delay", late)):
        if step == 0 or value % step:
            accepted = f"a multiple of plant.step, {spec.step:g} s"
            raise SpecError("does not divide into steps", key=key, value=value / NANOSECONDS, accepted=accepted)
    return control_period // step, late // step


def plane_limits(robot: Robot) -> tuple[Vector, float]:
    """(6,) limits of force and torque in the plane, 0 out of it, and the momentum the flywheel can store [N m s]."""
    force, limit, wheels = robot.actuators.base_force, np.zeros(6), robot.actuators.base_torque
    if force is not None:
        limit[:2] = force.limit[:2]
    limit[YAW] = torque_capacity(robot)[0][2]
    return limit, wheels.momentum if isinstance(wheels, ReactionWheels) else np.inf


def _check_planar(initial: InitialState, robot: Robot) -> None:
    if initial.q.size != 7 + robot.n:
        raise SpecError("wrong size", key="initial.q", value=initial.q.size, accepted=f"{7 + robot.n} numbers")
    outside = [*initial.q[2:5].tolist(), *initial.v[2:5].tolist()]
    if any(outside):
        raise SpecError("leaves the table", key="initial", value=outside, accepted="x, y, yaw and their rates only")


def _disturbance(spec: AirbearingSpec, rng: np.random.Generator) -> tuple[float, float, float]:
    """Force in x and y [N] and torque about z [N m], constant over a run."""
    angle, sign = rng.uniform(0.0, 2.0 * pi), 1.0 if rng.random() < 0.5 else -1.0
    push = spec.disturbance
    return push.force * cos(angle), push.force * sin(angle), push.torque * sign
