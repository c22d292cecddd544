"""Equations of motion of a robot whose last body is held by a grasp, and the work and impulse they book."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.grasp.law import Grasp
from space_robot_sim.kernel.tableau import STAGES, A, B
from space_robot_sim.triples import cross, quaternion_rate, turn, turn_back

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Push:
    """What acts during one control period.

    Attributes:
        force: of the thrusters on the base, body frame [N].
        moment: of that force about the base origin, body frame [N m].
        torque: asked of the wheels, body frame [N m].
        effort: of the joint motors [N m or N]; 0 at the grasp.
        outside_force: disturbance at the base origin, inertial frame [N].
        outside_torque: disturbance, inertial frame [N m].
    """

    force: Triple
    moment: Triple
    torque: Triple
    effort: tuple[float, ...]
    outside_force: Triple
    outside_torque: Triple


class GraspDynamics:
    """dy/dt of y = [q, v, bristle, wheel torque(3), wheel momentum(3), work, impulse(3), angular impulse(3)].

    q and v are those of RobotState. The wheels turn the base by their torque and store its opposite; their lag is
    first-order. Work is that of everything applied (grasp, motors, thrusters, wheels, disturbance), impulse that of
    what is external (thrusters, disturbance), about the inertial origin.

    Args:
        robot: the true robot.
        grasp: its forces.
        joints: indices of the grasp's three joints.
        lag: of the wheels [s].
    """

    def __init__(self, robot: Robot, grasp: Grasp, joints: tuple[int, int, int], lag: float) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._grasp, self._joints, self._lag, n = grasp, joints, lag, robot.n
        self.velocity, self.bristle = slice(7 + n, 13 + 2 * n), 13 + 2 * n
        self.wheel_torque = slice(14 + 2 * n, 17 + 2 * n)
        self.wheels = slice(17 + 2 * n, 20 + 2 * n)
        self.books = slice(20 + 2 * n, 27 + 2 * n)
        self.size, self.n = 27 + 2 * n, n
        self._stages = np.zeros((STAGES, self.size))
        self._q = pin.neutral(robot.model)

    def step(self, y: Vector, push: Push, h: float) -> Vector:
        """One step of DOP853 (order 8) of h [s]; nothing here depends on time."""
        stages = self._stages
        for s in range(STAGES):
            stages[s] = self.slope(y + h * (A[s, :s] @ stages[:s]), push)
        out: Vector = y + h * (B @ stages)
        return out

    def slope(self, y: Vector, push: Push) -> Vector:
        """dy/dt."""
        # On Python floats: at this size several times faster than on arrays.
        n, state = self.n, y.tolist()
        position, quaternion, joints = state[:3], state[3:7], state[7 : 7 + n]
        twist, omega, rates = state[7 + n : 13 + n], state[10 + n : 13 + n], state[13 + n : 13 + 2 * n]
        wheel_torque, wheels = state[self.wheel_torque], state[self.wheels]
        effort, stretch = self._efforts(joints, rates, state[self.bristle], push)
        outside, outside_torque = turn_back(quaternion, push.outside_force), turn_back(quaternion, push.outside_torque)
        force = [push.force[i] + outside[i] for i in range(3)]
        external = [push.moment[i] + outside_torque[i] for i in range(3)]
        gyroscopic = cross(omega, wheels)
        torque = [external[i] + wheel_torque[i] - gyroscopic[i] for i in range(3)]
        self._q[7:] = joints
        acceleration = pin.aba(self._model, self._data, self._q, y[self.velocity], np.array([*force, *torque, *effort]))
        inertial, moment = turn(quaternion, force), turn(quaternion, external)
        arm = cross(position, inertial)
        power = sum(a * b for a, b in zip((*force, *torque, *effort), (*twist, *rates), strict=True))
        # The torque has the gyroscopic part, which does no work: it is at right angles to omega.
        books = power, *inertial, *(arm[i] + moment[i] for i in range(3))
        turning = self._wheel_slope(wheel_torque, push.torque)
        rest = stretch, *turning, *(-part for part in wheel_torque), *books
        pose = (*turn(quaternion, twist[:3]), *quaternion_rate(quaternion, omega), *rates)
        return np.array([*pose, *acceleration.tolist(), *rest])

    def _efforts(
        self, joints: list[float], rates: list[float], bristle: float, push: Push
    ) -> tuple[list[float], float]:
        i, j, k = self._joints
        effort = list(push.effort)
        found = self._grasp.forces(joints[i], joints[j], rates[i], rates[j], rates[k], bristle)
        effort[i], effort[j], effort[k] = found.x, found.y, found.torque
        return effort, found.bristle_rate

    def _wheel_slope(self, torque: list[float], asked: Triple) -> list[float]:
        return [(asked[i] - torque[i]) / self._lag if self._lag > 0.0 else 0.0 for i in range(3)]
