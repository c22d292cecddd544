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
        self._q, self._tau = pin.neutral(robot.model), np.zeros(6 + n)

    def step(self, y: Vector, push: Push, h: float) -> Vector:
        """One step of DOP853 (order 8) of h [s]; nothing here depends on time."""
        stages = self._stages
        for s in range(STAGES):
            stages[s] = self.slope(y + h * (A[s, :s] @ stages[:s]), push)
        out: Vector = y + h * (B @ stages)
        return out

    def slope(self, y: Vector, push: Push) -> Vector:
        """dy/dt."""
        n, dy = self.n, np.empty(self.size)
        pose, v = y[:7].tolist(), y[self.velocity]
        quaternion, twist, rates = pose[3:], v[:6].tolist(), v[6:]
        omega, wheel_torque = twist[3:], y[self.wheel_torque].tolist()
        effort, stretch = self._efforts(y, rates, push)
        outside, outside_torque = turn_back(quaternion, push.outside_force), turn_back(quaternion, push.outside_torque)
        force = [push.force[i] + outside[i] for i in range(3)]
        external = [push.moment[i] + outside_torque[i] for i in range(3)]
        gyroscopic = cross(omega, y[self.wheels].tolist())
        tau = self._tau
        tau[:3], tau[6:] = force, effort
        tau[3:6] = [external[i] + wheel_torque[i] - gyroscopic[i] for i in range(3)]
        self._q[7:] = y[7 : 7 + n]
        dy[self.velocity] = pin.aba(self._model, self._data, self._q, v, tau)
        dy[:3], dy[3:7], dy[7 : 7 + n] = turn(quaternion, twist[:3]), quaternion_rate(quaternion, omega), rates
        dy[self.bristle] = stretch
        dy[self.wheel_torque] = self._wheel_slope(wheel_torque, push.torque)
        dy[self.wheels] = [-torque for torque in wheel_torque]
        inertial, moment = turn(quaternion, force), turn(quaternion, external)
        arm = cross(pose[:3], inertial)
        # tau has the gyroscopic torque, which does no work: it is at right angles to omega.
        dy[self.books] = [float(tau @ v), *inertial, *(arm[i] + moment[i] for i in range(3))]
        return dy

    def _efforts(self, y: Vector, rates: Vector, push: Push) -> tuple[Vector, float]:
        i, j, k = self._joints
        effort = np.array(push.effort)
        found = self._grasp.forces(
            float(y[7 + i]), float(y[7 + j]), float(rates[i]), float(rates[j]), float(rates[k]), float(y[self.bristle])
        )
        effort[i], effort[j], effort[k] = found.x, found.y, found.torque
        return effort, found.bristle_rate

    def _wheel_slope(self, torque: list[float], asked: Triple) -> list[float]:
        return [(asked[i] - torque[i]) / self._lag if self._lag > 0.0 else 0.0 for i in range(3)]
