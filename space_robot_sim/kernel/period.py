"""One control period from command to telemetry, in one call."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import expm1
from space_robot_sim.kernel.allocation import Allocation, Capability, allocate, allocation
from space_robot_sim.kernel.disturbance import NOTHING
from space_robot_sim.kernel.flexible import RIGID, stored_energy
from space_robot_sim.kernel.momentum import (
    ANGULAR,
    BALANCE_SIZE,
    ENERGY,
    GROSS_ANGULAR,
    GROSS_LINEAR,
    LINEAR,
    balance,
)
from space_robot_sim.kernel.rhs import FIRST, LAG, QUADRATURES, Drive, Scratch, motor_effort, scratch, slope
from space_robot_sim.kernel.steps import DONE, Stepping, integrate

GAUGES = 7


class PlantMemory(NamedTuple):
    """The plant between two periods, and the memory to get from one to the next.

    Attributes:
        y: (20+2n,) state, see `kernel.rhs`; longer where gears or joints are flexible.
        wheels: (k,) wheel momenta relative to the body [N m s].
        motors: (n,) efforts the motors give at this instant.
        effort: (n,) their mean over the period that just ended.
        initial: (9,) balance at the start of the run.
        now: (9,) balance at this instant.
        largest: (3,) largest gross linear and angular momentum and energy or work so far.
        gauges: (7,) residuals of linear and angular momentum, energy, quaternion; acceleration of the base origin(3).
        scratch: memory.
        allocation: memory.
        disturbance: (9,) what pushes the base beside the actuators, see `kernel.disturbance`; (0,): nothing.
        springs: (n, 5) see `kernel.flexible`; (0, 5): all is rigid.
    """

    y: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    motors: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    initial: npt.NDArray[np.float64]
    now: npt.NDArray[np.float64]
    largest: npt.NDArray[np.float64]
    gauges: npt.NDArray[np.float64]
    scratch: Scratch
    allocation: Allocation
    disturbance: npt.NDArray[np.float64] = NOTHING
    springs: npt.NDArray[np.float64] = RIGID


def plant_memory(joints: int, wheels: int, followers: int = 0, more: int = 0) -> PlantMemory:
    """Memory for a robot with that many joints and wheels, joints that follow others, and so many further states."""
    y = np.zeros(13 + 2 * joints + QUADRATURES + more)
    balance = np.zeros(BALANCE_SIZE), np.zeros(BALANCE_SIZE), np.zeros(3), np.zeros(GAUGES)
    motors, effort, memory = np.zeros(joints), np.zeros(joints), scratch(joints, followers, more)
    return PlantMemory(y, np.zeros(wheels), motors, effort, *balance, memory, allocation(joints, wheels))


class PlantContext(NamedTuple):
    """A plant as compiled code finds it: the robot, its actuators, how it is integrated, its state."""

    robot: RobotArrays
    able: Capability
    how: Stepping
    memory: PlantMemory


def _example() -> PlantContext:
    one, none, flags = np.zeros(1), np.zeros((1, 1)), np.zeros(1, dtype=np.int64)
    able = Capability(one, flags, flags, one, none, none, none, 0, 0, one, one)
    robot = RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)
    return PlantContext(robot, able, Stepping(0, 1.0, 1.0, 1.0, one), plant_memory(0, 0))


PLANT = kind_of(_example())


@kernel
def keep(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def advance(context: Any, command: Vector, period: float, start: bool) -> int:
    """One control period [s] under a command (6+n,); returns the status of `integrate`.

    With ``start`` no time passes: the conservation baseline is taken from the state as it is. One entry for both,
    because every entry from Python costs seconds when it is first compiled; and all is found by one address, because
    taking forty arrays out of Python's hands takes microseconds.

    Args:
        context: a ``PlantContext``, see ``description.kernel.context``.
        command: what acts.
        period: [s].
        start: see above.
    """
    robot, able, how, plant = loaded(context, PLANT)
    count = allocate(able, command, period, plant.wheels, plant.allocation)
    held = plant.allocation.segments, plant.allocation.effort, plant.motors
    drive = Drive(*held, plant.disturbance, plant.springs)
    if start:
        reset_baseline(robot, able, drive, plant)
        return DONE
    status = integrate(robot, drive, count, how, plant.y, plant.scratch)
    if status == DONE:
        settle(robot, able, period, plant)
    return status


@kernel
def reset_baseline(robot: RobotArrays, able: Capability, drive: Drive, plant: PlantMemory) -> None:
    """Balance and acceleration of the initial state, against which the run is measured."""
    slope(robot, drive, FIRST, 0.0, plant.y, plant.scratch.slope, plant.scratch)
    balance(robot, plant.y, able.axes, plant.wheels, plant.scratch.bodies, plant.initial)
    plant.initial[ENERGY] += stored_energy(plant.springs, plant.y)
    update_balance(robot, able, plant)
    plant.gauges[3] = 0.0


@kernel
def settle(robot: RobotArrays, able: Capability, period: float, plant: PlantMemory) -> None:
    """After the integration of a period: unit quaternion, motors and wheels at its end, the conservation balance."""
    settle_state(robot, able, period, plant)
    update_balance(robot, able, plant)


@inner
def settle_state(robot: RobotArrays, able: Capability, period: float, plant: PlantMemory) -> None:
    """``settle`` without the balance."""
    y = plant.y
    norm = math.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
    plant.gauges[3] = abs(norm - 1.0)
    for k in range(3, 7):
        y[k] /= norm
    for joint in range(plant.motors.shape[0]):
        asked, start, lag = plant.allocation.effort[joint], plant.motors[joint], robot.motors[joint, LAG]
        plant.motors[joint] = motor_effort(asked, start, lag, period)
        late = (start - asked) * lag * -expm1(-period / lag) / period if lag > 0.0 else 0.0
        plant.effort[joint] = asked + late
    for wheel in range(plant.wheels.shape[0]):
        limit = able.wheel_limit[wheel, 1]
        rate, stop = plant.allocation.level[6 + wheel], plant.allocation.stop[6 + wheel]
        plant.wheels[wheel] = max(-limit, min(limit, plant.wheels[wheel] + rate * stop))


@inner
def update_balance(robot: RobotArrays, able: Capability, plant: PlantMemory) -> None:
    """Balance at this instant, its residuals against the start of the run, and the base's acceleration."""
    balance(robot, plant.y, able.axes, plant.wheels, plant.scratch.bodies, plant.now)
    plant.now[ENERGY] += stored_energy(plant.springs, plant.y)
    update_residuals(plant)


@inner
def update_residuals(plant: PlantMemory) -> None:
    """``update_balance`` with the balance at this instant there already."""
    y, now, initial, largest, gauges = plant.y, plant.now, plant.initial, plant.largest, plant.gauges
    n = plant.motors.shape[0]
    work = 13 + 2 * n
    largest[0] = max(largest[0], now[GROSS_LINEAR])
    largest[1] = max(largest[1], now[GROSS_ANGULAR])
    largest[2] = max(largest[2], max(now[ENERGY], abs(y[work])))
    linear, angular = 0.0, 0.0
    for k in range(3):
        linear += (now[LINEAR + k] - initial[LINEAR + k] - y[work + 1 + k]) ** 2
        angular += (now[ANGULAR + k] - initial[ANGULAR + k] - y[work + 4 + k]) ** 2
    gauges[0] = _relative(math.sqrt(linear), largest[0])
    gauges[1] = _relative(math.sqrt(angular), largest[1])
    gauges[2] = _relative(abs(now[ENERGY] - initial[ENERGY] - y[work]), largest[2])
    slope = plant.scratch.slope
    v, w = (y[7 + n], y[8 + n], y[9 + n]), (y[10 + n], y[11 + n], y[12 + n])
    gauges[4] = slope[7 + n] + w[1] * v[2] - w[2] * v[1]
    gauges[5] = slope[8 + n] + w[2] * v[0] - w[0] * v[2]
    gauges[6] = slope[9 + n] + w[0] * v[1] - w[1] * v[0]


@inner
def _relative(error: float, scale: float) -> float:
    return error / scale if scale > 0.0 else 0.0
