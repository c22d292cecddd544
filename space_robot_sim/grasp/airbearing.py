"""The air-bearing testbed behind the Plant protocol: a base with flywheel and thrusters that holds a second body."""

from __future__ import annotations

from math import pi

import numpy as np

from space_robot_description.actuation import torque_capacity
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_sim.grasp.camera import Camera
from space_robot_sim.grasp.dynamics import Push
from space_robot_sim.grasp.plant import GraspedBody, whole_steps
from space_robot_sim.grasp.spec import AirbearingSpec
from space_robot_sim.initial import InitialState, RunConditions

FORWARD, SIDEWAYS, YAW = 0, 1, 5


class AirbearingTestbed(GraspedBody):
    """Two bodies that glide on a table: x, y and yaw of the base are pushed, everything else carries or gives way.

    The base is pushed by thrusters (their line of action misses the origin) and by a flywheel with lag; the robot's
    three joints named in the spec are the grasp. Commands out of the plane and to the grasp do nothing and show in
    ``command_ignored``. The state is what the cameras read.

    Args:
        robot: the truth: masses, inertias, where the grasp is, limits of thrusters and wheels.
        spec: the rest of the testbed.
        conditions: of the run; it starts in the plane, the seed is that of cameras and disturbance.

    Raises:
        SpecError: an argument does not fit the robot, the plane or the period.
    """

    def __init__(
        self,
        robot: Robot,
        spec: AirbearingSpec,
        conditions: RunConditions,
    ) -> None:
        if robot.n != 3:
            accepted = "a free-flying base and the three joints of the grasp"
            raise SpecError("does not lie on the table", key="robot", value=f"{robot.n} joints", accepted=accepted)
        _check_planar(conditions.initial)
        limit, self._full = plane_limits(robot)
        super().__init__(
            robot,
            spec.grasp,
            limit=limit,
            lag=spec.flywheel.lag,
            orbit=None,
            step=spec.step,
            seen=whole_steps(round(spec.camera.delay * NANOSECONDS), spec.step, "plant.camera.delay"),
            conditions=conditions,
        )
        self._offset = spec.thruster_offset
        camera_seed, push_seed = np.random.SeedSequence(conditions.seed).spawn(2)
        lengths = np.array(robot.prismatic)
        camera_number = int(camera_seed.generate_state(1, np.uint64)[0])
        self._camera = Camera(spec.camera, lengths, conditions.control_period, camera_number)
        self._outside = _disturbance(spec, np.random.default_rng(push_seed))
        self.reset()

    def _forget(self) -> None:
        self._camera.reset()

    def _see(self, push: Push) -> RobotState:
        return self._camera.measure(self._stamp, self._seen[0])

    def _push(self, acting: Vector) -> Push:
        """What the actuators make of a command."""
        allowed = np.clip(acting, -self._limit, self._limit)
        fx, fy, torque = float(allowed[FORWARD]), float(allowed[SIDEWAYS]), float(allowed[YAW])
        # A flywheel that is full takes no more: its momentum grows against the torque on the base.
        wheel = float(self._y[self.dynamics.wheels][2])
        if abs(wheel) >= self._full and wheel * torque < 0.0:
            torque = 0.0
        outside = self._outside
        return Push(
            force=(fx, fy, 0.0),
            moment=(0.0, 0.0, -self._offset * fx),
            torque=(0.0, 0.0, torque),
            effort=(0.0,) * self._n,
            outside_force=(outside[0], outside[1], 0.0),
            outside_torque=(0.0, 0.0, outside[2]),
        )


def plane_limits(robot: Robot) -> tuple[Vector, float]:
    """(6+n,) limits of a command in the plane, 0 elsewhere, and the momentum the flywheel can store [N m s]."""
    force, limit, wheels = robot.actuators.base_force, np.zeros(6 + robot.n), robot.actuators.base_torque
    if force is not None:
        limit[:2] = force.limit[:2]
    limit[YAW] = torque_capacity(robot)[0][2]
    return limit, wheels.momentum if isinstance(wheels, ReactionWheels) else np.inf


def _check_planar(initial: InitialState) -> None:
    outside = [*initial.q[2:5].tolist(), *initial.v[2:5].tolist()]
    if any(outside):
        raise SpecError("leaves the table", key="initial", value=outside, accepted="x, y, yaw and their rates only")


def _disturbance(spec: AirbearingSpec, rng: np.random.Generator) -> tuple[float, float, float]:
    """Force in x and y [N] and torque about z [N m], constant over a run."""
    angle, sign = rng.uniform(0.0, 2.0 * pi), 1.0 if rng.random() < 0.5 else -1.0
    push, (sine, cosine) = spec.disturbance, sincos(angle)
    return push.force * cosine, push.force * sine, push.torque * sign
