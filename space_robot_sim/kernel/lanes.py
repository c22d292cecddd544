"""One control period of several robots at once: the integration in lanes, all else robot by robot as ``period`` has it.

The right-hand side is the text of one robot, compiled for several numbers in place of one; every lane has the bits that
``period.advance`` gives it. A robot that has to step in another way than its neighbours, because an actuator stops
within the period or a step misses the tolerance, is left as it is: ``advance`` takes it.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import LINK_SIZE, RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.lanes import LANES, empty, seen
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.allocation import allocate
from space_robot_sim.kernel.coupled import CoupledMemory
from space_robot_sim.kernel.momentum import BALANCE_SIZE, balance
from space_robot_sim.kernel.period import (
    PLANT,
    PlantContext,
    PlantMemory,
    plant_memory,
    settle_state,
    update_residuals,
)
from space_robot_sim.kernel.rhs import FIRST, SEGMENT_SIZE, Drive, Scratch, slope
from space_robot_sim.kernel.steps import (
    DONE,
    DOP853_CHECKED,
    dop853_stages,
    equal_steps,
    step_error,
)

# What becomes of a robot in a period; its state is untouched but where it is DONE.
LEFT, IDLE = 100, 101


class LaneMemory(NamedTuple):
    """Several robots side by side, the last index is the lane.

    Attributes:
        links: (1+N, 22, L) see ``RobotArrays``.
        segments: (1, 14, L) see ``Drive``, and so the next two.
        effort: (n, L).
        start_effort: (n, L).
        y: (20+2n, L) states.
        wheels: (k, L) wheel momenta.
        now: (9, L) see ``PlantMemory``.
        worst: (1, L) largest error of a step relative to the tolerance.
        stages: see ``Scratch``, and so the next five.
        trial: likewise.
        slope: likewise.
        bodies: likewise.
        torque: likewise, ``effort`` there.
        error: likewise.
        motion: see ``CoupledMemory``, and so the next four.
        mass: likewise.
        unit: likewise.
        rest: likewise.
        force: likewise.
    """

    links: npt.NDArray[np.float64]
    segments: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    start_effort: npt.NDArray[np.float64]
    y: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    now: npt.NDArray[np.float64]
    worst: npt.NDArray[np.float64]
    stages: npt.NDArray[np.float64]
    trial: npt.NDArray[np.float64]
    slope: npt.NDArray[np.float64]
    bodies: npt.NDArray[np.float64]
    torque: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    motion: npt.NDArray[np.float64]
    mass: npt.NDArray[np.float64]
    unit: npt.NDArray[np.float64]
    rest: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]


def lane_memory(plant: PlantMemory, bodies: int) -> LaneMemory:
    """Memory for robots like one of that many bodies, whose memory is given."""

    def beside(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return empty(LANES, *array.shape)

    scratch, n = plant.scratch, plant.motors.size
    return LaneMemory(
        empty(LANES, bodies, int(LINK_SIZE)),
        empty(LANES, 1, int(SEGMENT_SIZE)),
        empty(LANES, n),
        empty(LANES, n),
        beside(plant.y),
        beside(plant.wheels),
        empty(LANES, int(BALANCE_SIZE)),
        empty(LANES, 1),
        *map(beside, scratch[:6]),
        *map(beside, scratch.coupled),
    )


MEMORY = kind_of(lane_memory(plant_memory(0, 0), 1))


@kernel
def keep_lanes(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def advance_lanes(plants: Any, memory: Any, commands: Vector, period: float, status: Vector) -> int:
    """One control period [s] of every robot that is not IDLE; see ``period.advance``.

    Args:
        plants: (L,) addresses of their ``PlantContext``, alike in tree, motors, axes and stepping.
        memory: address of a ``LaneMemory`` with the links of each.
        commands: (L, 6+n) what acts on each.
        period: [s].
        status: (L,) written where it is not IDLE: DONE, or LEFT where ``advance`` has to do it.
    """
    lanes = loaded(memory, MEMORY)
    for lane in range(LANES):
        if status[lane] != IDLE:
            plant = loaded(plants[lane], PLANT)
            count = allocate(plant.able, commands[lane], period, plant.memory.wheels, plant.memory.allocation)
            status[lane] = DONE if count == 1 else LEFT
        _gather(loaded(plants[lane], PLANT).memory, lane, lanes)
    _integrate(loaded(plants[0], PLANT), lanes, period)
    for lane in range(LANES):
        if status[lane] == DONE:
            plant = loaded(plants[lane], PLANT)
            status[lane] = _taken(plant, lane, lanes, period)
        _gather_settled(loaded(plants[lane], PLANT).memory, lane, lanes)
    _balance(loaded(plants[0], PLANT), lanes)
    for lane in range(LANES):
        if status[lane] == DONE:
            plant = loaded(plants[lane], PLANT)
            for i in range(BALANCE_SIZE):
                plant.memory.now[i] = lanes.now[i, lane]
            update_residuals(plant.memory)
    return DONE


@inner
def _gather(plant: PlantMemory, lane: int, lanes: LaneMemory) -> None:
    """What the integration of one robot begins with."""
    for i in range(SEGMENT_SIZE):
        lanes.segments[0, i, lane] = plant.allocation.segments[0, i]
    for joint in range(plant.motors.shape[0]):
        lanes.effort[joint, lane] = plant.allocation.effort[joint]
        lanes.start_effort[joint, lane] = plant.motors[joint]
    for i in range(plant.y.shape[0]):
        lanes.y[i, lane] = plant.y[i]
    lanes.error[0, lane] = plant.scratch.error[0]


@inner
def _robot(plant: PlantContext, lanes: LaneMemory) -> Any:
    return RobotArrays(plant.robot.tree, seen(lanes.links), plant.robot.motors, plant.robot.coupling)


@inner
def _integrate(plant: PlantContext, lanes: LaneMemory, period: float) -> None:
    """Take all lanes over the period, in fixed steps: ``steps.integrate`` for one segment."""
    robot, how, y = _robot(plant, lanes), plant.how, seen(lanes.y)
    segments, disturbance = seen(lanes.segments), plant.memory.disturbance
    drive = Drive(segments, seen(lanes.effort), seen(lanes.start_effort), disturbance)
    coupled = CoupledMemory(seen(lanes.motion), seen(lanes.mass), seen(lanes.unit), seen(lanes.rest), seen(lanes.force))
    scratch = Scratch(
        seen(lanes.stages),
        seen(lanes.trial),
        seen(lanes.slope),
        seen(lanes.bodies),
        seen(lanes.torque),
        seen(lanes.error),
        coupled,
    )
    worst, count = seen(lanes.worst), equal_steps(period, how.step)
    worst[0], h = 0.0, period / count
    for index in range(count):
        dop853_stages(robot, drive, FIRST, index * h, h, y, scratch, FIRST)
        error, lost = step_error(h, how, y, scratch)
        worst[0] = max(worst[0], error)
        scratch.error[0] += lost
        for i in range(y.shape[0]):
            y[i] = scratch.trial[i]
    slope(robot, drive, FIRST, period, y, scratch.slope, scratch)


@inner
def _taken(plant: PlantContext, lane: int, lanes: LaneMemory, period: float) -> int:
    """Let a robot have the state of its lane, if it would have come there alone."""
    memory, total = plant.memory, 0.0
    for i in range(memory.y.shape[0]):
        total += lanes.y[i, lane] + lanes.slope[i, lane]
    missed = plant.how.method == DOP853_CHECKED and lanes.worst[0, lane] > 1.0
    if missed or not math.isfinite(total):
        return LEFT
    for i in range(memory.y.shape[0]):
        memory.y[i], memory.scratch.slope[i] = lanes.y[i, lane], lanes.slope[i, lane]
    memory.scratch.error[0] = lanes.error[0, lane]
    settle_state(plant.robot, plant.able, period, memory)
    return DONE


@inner
def _gather_settled(plant: PlantMemory, lane: int, lanes: LaneMemory) -> None:
    """What the balance of one robot is made of."""
    for i in range(plant.y.shape[0]):
        lanes.y[i, lane] = plant.y[i]
    for wheel in range(plant.wheels.shape[0]):
        lanes.wheels[wheel, lane] = plant.wheels[wheel]


@inner
def _balance(plant: PlantContext, lanes: LaneMemory) -> None:
    balance(
        _robot(plant, lanes), seen(lanes.y), plant.able.axes, seen(lanes.wheels), seen(lanes.bodies), seen(lanes.now)
    )
