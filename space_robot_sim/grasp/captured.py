"""A robot in space that has captured debris: the whole arm, a grasp that slips, and central gravity if asked for."""

from __future__ import annotations

import numpy as np

from space_robot_description.actuation import torque_capacity
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_sim.grasp.dynamics import Push
from space_robot_sim.grasp.orbit import Orbit
from space_robot_sim.grasp.plant import GraspedBody
from space_robot_sim.grasp.spec import CapturedSpec, ConfigurationChange
from space_robot_sim.initial import RunConditions
from space_robot_sim.sensors import Sensors


class CapturedDebris(GraspedBody):
    """Every joint but the grasp has a motor; base force and torque come from thrusters.

    Args:
        robot: the truth, with the debris behind the three joints of the grasp.
        spec: the rest.
        conditions: of the run; the seed is that of the sensors.

    Raises:
        SpecError: an argument does not fit the robot or the period, or the robot turns its base with wheels.
    """

    def __init__(
        self,
        robot: Robot,
        spec: CapturedSpec,
        conditions: RunConditions,
    ) -> None:
        super().__init__(
            robot,
            spec.grasp,
            limit=capability(robot, spec),
            lag=0.0,
            orbit=None if spec.orbit is None else Orbit(spec.orbit),
            step=spec.step,
            seen=0,
            conditions=conditions,
        )
        self._sensors = Sensors(spec.sensors, robot.n, conditions.control_period, conditions.seed)
        self._change = spec.change
        self.reset()

    def _forget(self) -> None:
        self._sensors.reset()

    def _push(self, acting: Vector) -> Push:
        allowed = np.clip(acting, -self._limit, self._limit).tolist()
        seconds, period = self._stamp / NANOSECONDS, self._period / NANOSECONDS
        rest, turned = _shift(self._change, seconds + period)
        turning = (turned - _shift(self._change, seconds)[1]) / period
        force, moment = (allowed[0], allowed[1], allowed[2]), (allowed[3], allowed[4], allowed[5])
        return Push(force, moment, (0.0, 0.0, 0.0), tuple(allowed[6:]), rest=rest, turning=turning)

    def _see(self, push: Push) -> RobotState:
        n, y = self._n, self._y
        velocity = y[self.dynamics.velocity]
        slope = self.dynamics.slope(y, push, self._stamp / NANOSECONDS)[self.dynamics.velocity]
        acceleration = slope[:3] + np.cross(velocity[3:6], velocity[:3])
        truth = RobotState(self._stamp, y[: 7 + n], velocity, np.array(push.effort), acceleration)
        return self._sensors.measure(truth)


def capability(robot: Robot, spec: CapturedSpec) -> Vector:
    """(6+n,) limits of force, torque and motors; 0 at the grasp.

    Raises:
        SpecError: the base has reaction wheels.
    """
    if isinstance(robot.actuators.base_torque, ReactionWheels):
        raise SpecError("has reaction wheels", key="robot.actuators.base_torque", accepted="thrusters or ideal torques")
    force = robot.actuators.base_force
    joints = np.where([name in spec.grasp.joints for name in robot.joint_names], 0.0, robot.effort_limit)
    return np.concatenate([force.limit if force else np.zeros(3), torque_capacity(robot)[0], joints])


def _shift(change: ConfigurationChange | None, t: float) -> tuple[float, float]:
    """Where the grasp rests at a time [s]: along its first joint [m], about its third [rad]."""
    if change is None:
        return 0.0, 0.0
    tau = min(max((t - change.start) / change.duration, 0.0), 1.0)
    share = tau * tau * tau * (10.0 + tau * (6.0 * tau - 15.0))
    return share * change.offset, share * float(np.radians(change.angle_deg))
