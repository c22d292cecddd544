"""Equations of motion of a robot whose last body is held by a grasp, and the work and impulse they book."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.kernel import jit
from space_robot_description.kernel.arrays import robot_arrays
from space_robot_description.kernel.jit import bound
from space_robot_description.robot import Robot
from space_robot_description.rotations import Three, conjugate, cross, quaternion_rate, rotate_by_matrix
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times
from space_robot_sim.grasp.kernel.step import GraspRule, grasp_step, grasp_work
from space_robot_sim.grasp.law import Grasp
from space_robot_sim.grasp.orbit import Orbit, crosses
from space_robot_sim.kernel.tableau import STAGES, A, B, C

NOTHING: Three = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Push:
    """What acts during one control period.

    Attributes:
        force: of the thrusters on the base, body frame [N].
        moment: of that force about the base origin, body frame [N m].
        torque: asked of the wheels, body frame [N m].
        effort: of the joint motors [N m or N]; 0 at the grasp.
        outside_force: disturbance at the base origin, inertial frame [N].
        outside_torque: disturbance, inertial frame [N m].
        rest: where the first joint of the grasp has no force [m].
        turning: rate at which its third joint has no torque [rad/s].
    """

    force: Three
    moment: Three
    torque: Three
    effort: tuple[float, ...]
    outside_force: Three = NOTHING
    outside_torque: Three = NOTHING
    rest: float = 0.0
    turning: float = 0.0

    @cached_property
    def numbers(self) -> Vector:
        """(17+n,) all of it, in the order of ``kernel/step.py``."""
        acting, outside = (*self.force, *self.moment, *self.torque), (*self.outside_force, *self.outside_torque)
        return np.array([*acting, *outside, self.rest, self.turning, *self.effort])

    @classmethod
    def none(cls, n: int) -> Push:
        """Nothing acts on a robot of n joints."""
        return cls(NOTHING, NOTHING, NOTHING, (0.0,) * n)


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
        orbit: pulls every body at its centre of mass and turns it by the gradient; None: free space.
    """

    def __init__(
        self, robot: Robot, grasp: Grasp, joints: tuple[int, int, int], lag: float, orbit: Orbit | None = None
    ) -> None:
        self._orbit, bodies = orbit, list(robot.model.inertias)[1:]
        self._masses, self._levers = np.array([one.mass for one in bodies]), np.array([one.lever for one in bodies])
        self._inertias = np.array([one.inertia for one in bodies])
        self._model, self._data = robot.model, robot.model.createData()
        self._grasp, self._joints, self._lag, n = grasp, joints, lag, robot.n
        self.velocity, self.bristle = slice(7 + n, 13 + 2 * n), 13 + 2 * n
        self.wheel_torque = slice(14 + 2 * n, 17 + 2 * n)
        self.wheels = slice(17 + 2 * n, 20 + 2 * n)
        self.balance = slice(20 + 2 * n, 27 + 2 * n)
        self.size, self.n = 27 + 2 * n, n
        self._stages = np.zeros((STAGES, self.size))
        self._q = pin.neutral(robot.model)
        self._kernel = self._compiled(robot) if orbit is None and jit.MACHINE_CODE else None

    def _compiled(self, robot: Robot) -> Callable[[Vector, Push, float], None]:
        """A step in machine code; where there is gravity or no compiler, it is made of ``slope``."""
        arrays, spec = robot_arrays(robot.model), self._grasp.spec
        springs = spec.stiffness, spec.damping, spec.torsional_stiffness, spec.torsional_damping, spec.slip_torque
        rule = GraspRule(np.array(self._joints, dtype=np.int64), *springs, self._lag)
        work, example = grasp_work(self.n, self.size), np.zeros(17 + self.n)
        step = bound(grasp_step, arrays, rule, example, np.zeros(self.size), 0.0, work)
        return lambda y, push, h: step(arrays, rule, push.numbers, y, h, work)

    def step(self, y: Vector, push: Push, t: float, h: float) -> Vector:
        """One step of DOP853 (order 8) of h [s] from t [s] on."""
        if self._kernel is not None:
            found = y.copy()
            self._kernel(found, push, h)
            return found
        stages = self._stages
        for s in range(STAGES):
            stages[s] = self.slope(y + h * times(A[s : s + 1, :s], stages[:s])[0], push, t + C[s] * h)
        out: Vector = y + h * times(B[None, :], stages)[0]
        return out

    def slope(self, y: Vector, push: Push, t: float) -> Vector:
        """dy/dt at a time [s]."""
        # On Python floats: at this size several times faster than on arrays.
        n, state = self.n, y.tolist()
        position, quaternion, joints = state[:3], state[3:7], state[7 : 7 + n]
        twist, omega, rates = state[7 + n : 13 + n], state[10 + n : 13 + n], state[13 + n : 13 + 2 * n]
        wheel_torque, wheels = state[self.wheel_torque], state[self.wheels]
        effort, stretch = self._efforts(joints, rates, state[self.bristle], push)
        to_body = conjugate(quaternion)
        outside, outside_torque = (
            rotate_by_matrix(to_body, vector) for vector in (push.outside_force, push.outside_torque)
        )
        force = [push.force[i] + outside[i] for i in range(3)]
        external = [push.moment[i] + outside_torque[i] for i in range(3)]
        gyroscopic = cross(omega, wheels)
        torque = [external[i] + wheel_torque[i] - gyroscopic[i] for i in range(3)]
        self._q[7:] = joints
        applied = np.array([*force, *torque, *effort])
        weight, weight_balance = self._weight(t, y)
        acceleration = pin.aba(self._model, self._data, self._q, y[self.velocity], applied, *weight)
        inertial, moment = rotate_by_matrix(quaternion, force), rotate_by_matrix(quaternion, external)
        arm = cross(position, inertial)
        power = sum(a * b for a, b in zip((*force, *torque, *effort), (*twist, *rates), strict=True))
        # The torque has the gyroscopic part, which does no work: it is at right angles to omega.
        balance = [power, *inertial, *(arm[i] + moment[i] for i in range(3))]
        balance = [a + b for a, b in zip(balance, weight_balance, strict=True)]
        turning = self._wheel_slope(wheel_torque, push.torque)
        rest = stretch, *turning, *(-part for part in wheel_torque), *balance
        pose = (*rotate_by_matrix(quaternion, twist[:3]), *quaternion_rate(quaternion, omega), *rates)
        return np.array([*pose, *acceleration.tolist(), *rest])

    def _weight(self, t: float, y: Vector) -> tuple[tuple[Any, ...], Vector]:
        """What gravity does: the wrench on every joint's body in its frame, and its power, force and moment (7)."""
        balance = np.zeros(7)
        if self._orbit is None:
            return (), balance
        pin.forwardKinematics(self._model, self._data, self._q, y[self.velocity])
        base, bodies = pin.Quaternion(y[3:7]).matrix(), range(1, self._model.njoints)
        places = [self._data.oMi[body] for body in bodies]
        turns = np.einsum("ij,kjl->kil", base, np.array([place.rotation for place in places]))
        levers = np.einsum("kij,kj->ki", turns, self._levers)
        centres = y[:3] + times(np.array([place.translation for place in places]), base.T) + levers
        fall = np.array([self._orbit.acceleration(t, (x, y, z)) for x, y, z in centres.tolist()])
        force = self._masses[:, None] * fall
        torque = self._orbit.gradient_torque(t, centres, turns, self._inertias)
        own_force = np.einsum("kji,kj->ki", turns, force)
        own = np.hstack([own_force, crosses(self._levers, own_force) + torque])
        twists = np.array([self._data.v[body].vector for body in bodies])
        balance[0], balance[1:4] = np.sum(own * twists), force.sum(axis=0)
        balance[4:] = np.sum(crosses(centres, force) + np.einsum("kij,kj->ki", turns, torque), axis=0)
        wrenches = pin.StdVec_Force()
        wrenches.append(pin.Force.Zero())
        for wrench in own:
            wrenches.append(pin.Force(wrench))
        return (wrenches,), balance

    def _efforts(
        self, joints: list[float], rates: list[float], bristle: float, push: Push
    ) -> tuple[list[float], float]:
        i, j, k = self._joints
        effort = list(push.effort)
        offsets, turning = (joints[i] - push.rest, joints[j]), rates[k] - push.turning
        found = self._grasp.forces(*offsets, rates[i], rates[j], turning, bristle)
        effort[i], effort[j], effort[k] = found.x, found.y, found.torque
        return effort, found.bristle_rate

    def _wheel_slope(self, torque: list[float], asked: Three) -> list[float]:
        return [(asked[i] - torque[i]) / self._lag if self._lag > 0.0 else 0.0 for i in range(3)]
