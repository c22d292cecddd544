"""The same equations and steps over ``pin.aba`` in NumPy, for machines without numba and as a check on the kernel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.kernel.arrays import RobotArrays, locked_joints
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.rotations import cross, quaternion_rate, rotate_by_matrix, rotate_inverse
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.flexible.springs import ANGLE, DAMPING, ROTOR, SPEED, STIFFNESS
from space_robot_sim.kernel.disturbance import AT, PUSH, TWIST
from space_robot_sim.kernel.rhs import (
    BEGIN,
    COULOMB,
    COULOMB_VELOCITY,
    END,
    FORCE,
    LAG,
    RATE,
    STORED,
    TORQUE,
    VISCOUS,
    Drive,
    Scratch,
)
from space_robot_sim.kernel.steps import (
    DONE,
    DOP853_ADAPTIVE,
    DOP853_CHECKED,
    NOT_FINITE,
    RK4,
    STEP_BOUND,
    TOO_MANY_STEPS,
    Stepping,
    step_factor,
)
from space_robot_sim.kernel.tableau import ERROR_3, ERROR_5, STAGES, A, B, C


class PinocchioIntegrator:
    """Integrates one control period; the counterpart of `kernel.steps.integrate`.

    Args:
        model: ``pin.Model`` of the robot, free-flyer root, no gravity.
        robot: the same robot as arrays, for its motors.
    """

    def __init__(self, model: Any, robot: RobotArrays) -> None:
        self._coupled, self._held = bool(robot.coupling.size), locked_joints(robot)
        held = self._held
        if held.any() and not self._coupled:
            # A rotor that nothing can turn: a joint that stands still, exactly.
            model = model.copy()
            model.armature[6:] = np.where(held, np.inf, 0.0)
        self._model, self._data = model, model.createData()
        self._lag, self._viscous = robot.motors[:, LAG], robot.motors[:, VISCOUS]
        self._coulomb, self._coulomb_velocity = robot.motors[:, COULOMB], robot.motors[:, COULOMB_VELOCITY]
        self._ideal = not robot.motors[:, :COULOMB_VELOCITY].any()
        # Without gravity the dynamics do not depend on the pose of the base: pinocchio sees it at the origin.
        self._q = pin.neutral(model)
        self._tau = np.zeros(model.nv)

    def integrate(self, drive: Drive, count: int, how: Stepping, y: Vector, memory: Scratch) -> int:
        """Take y through ``count`` segments, leave dy/dt at the end in ``memory.slope``; returns a status."""
        status, self._error = DONE, 0.0
        with np.errstate(over="ignore", invalid="ignore"):
            budget = STEP_BOUND
            for k in range(count):
                if how.method == DOP853_ADAPTIVE:
                    span = float(drive.segments[k, BEGIN]), float(drive.segments[k, END])
                    budget = self._adaptive(drive, k, span, how, y, memory.stages, budget)
                else:
                    budget = self._fixed(drive, k, how, y, memory.stages, budget)
                if budget <= 0:
                    status = TOO_MANY_STEPS
                    break
            memory.error[0] += self._error
            memory.slope[:] = self.slope(drive, count - 1, float(drive.segments[count - 1, END]), y)
            finite = bool(np.isfinite(y.sum() + memory.slope.sum()))
        return status if finite else NOT_FINITE

    def slope(self, drive: Drive, k: int, t: float, y: Vector) -> Vector:
        """dy/dt in segment k, t seconds after the beginning of the period."""
        n = self._model.nv - 6
        # Three-vectors as Python floats: NumPy's overhead on so little would cost ten times the dynamics.
        segment, pose, twist = drive.segments[k].tolist(), y[:7].tolist(), y[7 + n : 13 + n].tolist()
        v, omega, rates = twist[:3], twist[3:], y[13 + n : 13 + 2 * n]
        force, torque, rate = segment[FORCE:TORQUE], segment[TORQUE:RATE], segment[RATE:STORED]
        momentum = [h + (t - segment[BEGIN]) * dh for h, dh in zip(segment[STORED:], rate, strict=True)]
        gyroscopic = cross(omega, momentum)
        dy = np.empty_like(y)
        motor, effort, lost = self._efforts(drive, t, y, dy)
        self._tau[:3], self._tau[6:] = force, effort
        self._tau[3:6] = [torque[i] - rate[i] - gyroscopic[i] for i in range(3)]
        if drive.disturbance.size:
            self._tau[:6] += wrench_of(drive.disturbance, pose[3:])
        self._q[7:] = y[7 : 7 + n]
        dy[7 + n : 13 + 2 * n] = self._acceleration(y[7 + n : 13 + 2 * n])
        dy[:3] = rotate_by_matrix(pose[3:], v)
        dy[3:7] = quaternion_rate(pose[3:], omega)
        dy[7 : 7 + n] = rates
        inertial, moment = rotate_by_matrix(pose[3:], force), rotate_by_matrix(pose[3:], torque)
        arm = cross(pose[:3], inertial)
        dy[13 + 2 * n] = motor - lost + sum(force[i] * v[i] + (torque[i] - rate[i]) * omega[i] for i in range(3))
        dy[14 + 2 * n : 17 + 2 * n] = inertial
        dy[17 + 2 * n : 20 + 2 * n] = [arm[i] + moment[i] for i in range(3)]
        if drive.disturbance.size:
            dy[13 + 2 * n : 20 + 2 * n] += _counted(drive.disturbance, pose, twist)
        return dy

    def _acceleration(self, v: Vector) -> Vector:
        """Under the forces of now; joints that follow others have no place in ``pin.aba``."""
        model, data = self._model, self._data
        if not self._coupled:
            found: Vector = pin.aba(model, data, self._q, v, self._tau)
            return found
        right = self._tau - pin.nonLinearEffects(model, data, self._q, v)
        free = np.r_[np.ones(6, dtype=bool), ~self._held]
        out, mass = np.zeros(v.size), mass_matrix(model, self._q)
        out[free] = np.linalg.solve(mass[np.ix_(free, free)], right[free])
        return out

    def _efforts(self, drive: Drive, t: float, y: Vector, dy: Vector) -> tuple[float, Vector, float]:
        """Power of the motors less friction, efforts on the links, power lost in dampers; writes dy of the motors."""
        n, springs = self._model.nv - 6, drive.springs
        rates = y[13 + n : 13 + 2 * n]
        if not springs.size:
            effort = self._effort(drive, t, rates)
            return float(effort @ rates), effort, 0.0
        gears = np.flatnonzero(springs[:, ROTOR])
        angle, speed = springs[gears, ANGLE].astype(int), springs[gears, SPEED].astype(int)
        driven, twist, slip = rates.copy(), -y[7 : 7 + n], -rates
        driven[gears], twist[gears], slip[gears] = y[speed], twist[gears] + y[angle], slip[gears] + y[speed]
        effort = self._effort(drive, t, driven)
        given, power = springs[:, STIFFNESS] * twist + springs[:, DAMPING] * slip, float(effort @ driven)
        dy[angle], dy[speed] = y[speed], (effort - given)[gears] / springs[gears, ROTOR]
        effort = effort + given
        effort[gears] = given[gears]
        lost = float(springs[:, DAMPING] @ slip**2)
        dy[20 + 2 * n] = lost
        return power, effort, lost

    def _effort(self, drive: Drive, t: float, rates: Vector) -> Vector:
        """Motor effort less friction."""
        if self._ideal:
            return drive.effort
        gone = np.where(self._lag > 0.0, np.exp(-t / np.where(self._lag > 0.0, self._lag, 1.0)), 0.0)
        motor = drive.effort + (drive.start_effort - drive.effort) * gone
        out: Vector = motor - self._viscous * rates - self._coulomb * np.tanh(rates / self._coulomb_velocity)
        return out

    def _fixed(self, drive: Drive, k: int, how: Stepping, y: Vector, stages: Vector, budget: int) -> int:
        begin, end = float(drive.segments[k, BEGIN]), float(drive.segments[k, END])
        count = max(1, math.ceil((end - begin) / how.step - 1e-9))
        h = (end - begin) / count
        for index in range(count):
            t = begin + index * h
            new = self._rk4(drive, k, t, h, y) if how.method == RK4 else self._dop853(drive, k, t, h, y, stages, 0)
            error, lost = (0.0, 0.0) if how.method == RK4 else _step_error(h, how, y, new, stages)
            if how.method != DOP853_CHECKED or not 1.0 < error < math.inf:
                self._error += lost
                y[:] = new
                continue
            how.next_step[0] = h * step_factor(error, 1.0)
            budget = self._adaptive(drive, k, (t, t + h), how, y, stages, budget)
            if budget <= 0:
                break
        return budget

    def _dop853(self, drive: Drive, k: int, t: float, h: float, y: Vector, stages: Vector, first: int) -> Vector:
        for s in range(first, STAGES):
            stages[s] = self.slope(drive, k, t + C[s] * h, y + h * (A[s, :s] @ stages[:s]))
        return y + h * (B @ stages)

    def _rk4(self, drive: Drive, k: int, t: float, h: float, y: Vector) -> Vector:
        k1 = self.slope(drive, k, t, y)
        k2 = self.slope(drive, k, t + 0.5 * h, y + 0.5 * h * k1)
        k3 = self.slope(drive, k, t + 0.5 * h, y + 0.5 * h * k2)
        k4 = self.slope(drive, k, t + h, y + h * k3)
        return y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)

    def _adaptive(
        self,
        drive: Drive,
        k: int,
        span: tuple[float, float],
        how: Stepping,
        y: Vector,
        stages: Vector,
        budget: int,
    ) -> int:
        (t, end), first, most = span, 0, 5.0
        wish = float(how.next_step[0]) or end - t
        while t < end:
            budget -= 1
            h = min(wish, end - t)
            if budget <= 0 or t + h == t:
                return 0
            new = self._dop853(drive, k, t, h, y, stages, first)
            error, lost = _step_error(h, how, y, new, stages)
            factor = step_factor(error, most)
            if error <= 1.0:
                t = end if h == end - t else t + h
                self._error += lost
                y[:] = new
                wish = max(wish, h * factor) if h < wish else h * factor
                first, most = 0, 5.0
            else:
                wish, first, most = h * factor, 1, 1.0
        how.next_step[0] = wish
        return budget


def wrench_of(disturbance: Vector, quaternion: Sequence[float]) -> Vector:
    """(6,) force on the base and moment about its origin, body frame; the text of `kernel.disturbance`."""
    force = rotate_inverse(quaternion, disturbance[PUSH:AT].tolist())
    arm = cross(disturbance[AT:TWIST].tolist(), force)
    return np.concatenate([force, np.array(arm) + disturbance[TWIST:]])


def _counted(disturbance: Vector, pose: Sequence[float], twist: Sequence[float]) -> Vector:
    """(7,) its power, force and moment about the inertial origin."""
    wrench, push = wrench_of(disturbance, pose[3:]), disturbance[PUSH:AT]
    moment = np.array(cross(pose[:3], push.tolist())) + rotate_by_matrix(pose[3:], wrench[3:].tolist())
    return np.concatenate([[float(wrench @ np.array(twist))], push, moment])


def _step_error(h: float, how: Stepping, y: Vector, new: Vector, stages: Vector) -> tuple[float, float]:
    """Error relative to the tolerance, and the largest of the configuration; see `kernel.steps`."""
    scale = how.atol + how.rtol * np.maximum(np.abs(y), np.abs(new))
    error_5, error_3 = ERROR_5 @ stages, ERROR_3 @ stages
    sum_5, sum_3 = float(np.sum((error_5 / scale) ** 2)), float(np.sum((error_3 / scale) ** 2))
    if sum_5 == 0.0 and sum_3 == 0.0:
        return 0.0, 0.0
    squares = error_5[: 7 + (y.size - 20) // 2] ** 2
    total = np.sqrt(squares + 0.01 * error_3[: squares.size] ** 2)
    largest = abs(h) * float(np.divide(squares, total, out=np.zeros_like(total), where=total > 0.0).max())
    return abs(h) * sum_5 / math.sqrt((sum_5 + 0.01 * sum_3) * y.size), largest
