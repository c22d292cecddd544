"""One control period by fixed or error-controlled steps that never cross the edge of a segment."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import power
from space_robot_sim.kernel.rhs import BEGIN, END, FIRST, Drive, Scratch, slope
from space_robot_sim.kernel.tableau import ERROR_3, ERROR_5, STAGES, A, B, C

DOP853, DOP853_ADAPTIVE, RK4, DOP853_CHECKED = 0, 1, 2, 3
DONE, NOT_FINITE, TOO_MANY_STEPS = 0, 1, 2
(STEP_BOUND,) = constants(20_000)
# Below any square root of a number that is not zero.
TINY = float(np.finfo(np.float64).tiny)


class Stepping(NamedTuple):
    """How to integrate.

    Attributes:
        method: DOP853, DOP853_ADAPTIVE, RK4 or DOP853_CHECKED: fixed steps, and adaptive ones in place of each that
            misses the tolerance.
        step: longest fixed step [s].
        rtol: relative tolerance of one step, adaptive or checked.
        atol: absolute tolerance of one step, in the units of each state.
        next_step: (1,) the adaptive step to try next [s]; 0: the whole segment.
    """

    method: int
    step: float
    rtol: float
    atol: float
    next_step: npt.NDArray[np.float64]


@kernel
def integrate(robot: RobotArrays, drive: Drive, count: int, how: Stepping, y: Vector, memory: Scratch) -> int:
    """Take y from the beginning of the first to the end of the last of ``count`` segments; returns a status.

    On return ``memory.slope`` is dy/dt at the end, under the efforts just held.
    """
    status, budget = DONE, STEP_BOUND
    for k in range(count):
        if how.method == DOP853_ADAPTIVE:
            begin, end = drive.segments[k, BEGIN], drive.segments[k, END]
            budget = _adaptive(robot, drive, k, begin, end, how, y, memory, budget)
        else:
            budget = _fixed(robot, drive, k, how, y, memory, budget)
        if budget <= 0:
            status = TOO_MANY_STEPS
            break
    slope(robot, drive, count - 1, drive.segments[count - 1, END], y, memory.slope, memory)
    total = 0.0
    for i in range(y.shape[0]):
        total += y[i] + memory.slope[i]
    return status if math.isfinite(total) else NOT_FINITE


@inner
def _fixed(robot: RobotArrays, drive: Drive, k: int, how: Stepping, y: Vector, memory: Scratch, budget: int) -> int:
    """Cross one segment in equal steps; returns what is left of the budget of adaptive ones."""
    begin, end = drive.segments[k, BEGIN], drive.segments[k, END]
    count = equal_steps(end - begin, how.step)
    h = (end - begin) / count
    for index in range(count):
        t = begin + index * h
        if how.method == RK4:
            _rk4(robot, drive, k, t, h, y, memory)
        else:
            dop853_stages(robot, drive, k, t, h, y, memory, FIRST)
            error, lost = step_error(h, how, y, memory)
            if how.method == DOP853 or not 1.0 < error < math.inf:
                memory.error[0] += lost
                # What is not finite is so after shorter steps, too, and shows at the end.
                for i in range(y.shape[0]):
                    y[i] = memory.trial[i]
            else:
                how.next_step[0] = h * step_factor(error, 1.0)
                budget = _adaptive(robot, drive, k, t, t + h, how, y, memory, budget)
                if budget <= 0:
                    break
    return budget


@inner
def equal_steps(length: float, longest: float) -> int:
    """How many equal steps take a length [s] in steps of no more than the longest."""
    # The margin keeps round-off in the length of a segment from costing one more step.
    return max(1, math.ceil(length / longest - 1e-9))


@inner
def dop853_stages(
    robot: RobotArrays, drive: Drive, k: int, t: float, h: float, y: Vector, memory: Scratch, first: int
) -> None:
    """Evaluate stages from ``first`` on (an earlier try may have left stage 0) and put the result in memory.trial."""
    stages, trial = memory.stages, memory.trial
    size = y.shape[0]
    for s in range(first, STAGES):
        for i in range(size):
            trial[i] = y[i]
        for j in range(s):
            weight = h * A[s, j]
            if weight != 0.0:
                for i in range(size):
                    trial[i] += weight * stages[j, i]
        slope(robot, drive, k, t + C[s] * h, trial, stages[s], memory)
    for i in range(size):
        trial[i] = y[i]
    for j in range(STAGES):
        weight = h * B[j]
        if weight != 0.0:
            for i in range(size):
                trial[i] += weight * stages[j, i]


@inner
def _adaptive(
    robot: RobotArrays,
    drive: Drive,
    k: int,
    t: float,
    end: float,
    how: Stepping,
    y: Vector,
    memory: Scratch,
    budget: int,
) -> int:
    """From t to the end within a segment under error control; returns what is left of the budget of steps, or 0."""
    first, most = 0, 5.0
    wish = how.next_step[0] if how.next_step[0] > 0.0 else end - t
    while t < end:
        budget -= 1
        h = min(wish, end - t)
        if budget <= 0 or t + h == t:
            return 0
        dop853_stages(robot, drive, k, t, h, y, memory, first)
        error, lost = step_error(h, how, y, memory)
        factor = step_factor(error, most)
        if error <= 1.0:
            t = end if h == end - t else t + h
            memory.error[0] += lost
            for i in range(y.shape[0]):
                y[i] = memory.trial[i]
            # A step cut short by the end of the segment says little about how long the next may be.
            wish = max(wish, h * factor) if h < wish else h * factor
            first, most = 0, 5.0
        else:
            wish, first, most = h * factor, 1, 1.0
    how.next_step[0] = wish
    return budget


@kernel
def step_factor(error: float, most: float) -> float:
    """How much longer the next step may be, from the error relative to the tolerance (not a number: much shorter)."""
    if not math.isfinite(error):
        return 0.2
    return min(most, max(0.2, 0.9 * power(error, -0.125))) if error > 0.0 else most


@inner
def step_error(h: float, how: Stepping, y: Vector, memory: Scratch) -> tuple[float, float]:
    """Error of the step relative to the tolerance (Hairer, Norsett, Wanner, sec. II.10, eq. 10.17).

    Beside it the largest error of the configuration [m or rad], each component by the same formula. No branch depends
    on a number of the state: lanes take the same way.
    """
    # Row by row, in the place of two stages that neither estimate nor the next try needs: rows are contiguous.
    errors_5, errors_3 = memory.stages[1], memory.stages[2]
    for i in range(y.shape[0]):
        errors_5[i], errors_3[i] = ERROR_5[0] * memory.stages[0, i], ERROR_3[0] * memory.stages[0, i]
    for s in range(5, STAGES):
        for i in range(y.shape[0]):
            errors_5[i] += ERROR_5[s] * memory.stages[s, i]
            errors_3[i] += ERROR_3[s] * memory.stages[s, i]
    sum_5, sum_3, largest = 0.0, 0.0, 0.0
    for i in range(y.shape[0]):
        scale = how.atol + how.rtol * max(abs(y[i]), abs(memory.trial[i]))
        a, b = errors_5[i] / scale, errors_3[i] / scale
        sum_5 += a * a
        sum_3 += b * b
    # Nothing over nothing is no error.
    for i in range(7 + memory.effort.shape[0]):
        square = errors_5[i] * errors_5[i]
        size = math.sqrt(square + 0.01 * (errors_3[i] * errors_3[i]))
        largest = max(largest, abs(h) * square / max(size, TINY))
    size = math.sqrt((sum_5 + 0.01 * sum_3) * y.shape[0])
    return abs(h) * sum_5 / max(size, TINY), largest


@inner
def _rk4(robot: RobotArrays, drive: Drive, k: int, t: float, h: float, y: Vector, memory: Scratch) -> None:
    stages, trial = memory.stages, memory.trial
    size = y.shape[0]
    slope(robot, drive, k, t, y, stages[0], memory)
    for s in range(1, 4):
        part = h if s == 3 else 0.5 * h
        for i in range(size):
            trial[i] = y[i] + part * stages[s - 1, i]
        slope(robot, drive, k, t + part, trial, stages[s], memory)
    for i in range(size):
        y[i] += h / 6.0 * (stages[0, i] + 2.0 * (stages[1, i] + stages[2, i]) + stages[3, i])
