"""The incremental law (16); the equations are those of ``IncrementalController``.

Reference: [Song et al. 2023, (16)].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.laws.mfac.kernel.gradient import LEAST, GradientMemory, push
from space_robot_description.kernel.dense import excess_of, factor, solve
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector

# Beside the statuses of all laws: lambda + phi^T phi has no inverse.
SINGULAR = 2


class IncrementRule(NamedTuple):
    """The numbers of the law.

    Attributes:
        outputs: Ly.
        inputs: Lu.
        rho: (Ly+Lu, m).
        share: (m,) 1 + kappa.
        control: (1,) lambda that is added.
        limit: (m,) largest |u|.
    """

    outputs: int
    inputs: int
    rho: npt.NDArray[np.float64]
    share: npt.NDArray[np.float64]
    control: npt.NDArray[np.float64]
    limit: npt.NDArray[np.float64]


class IncrementMemory(NamedTuple):
    """What the law remembers, and room for one answer.

    Attributes:
        past: (Ly+Lu, m) increments of the outputs, the newest first, then those of the inputs.
        proportional: (m,) sum of the responses to increments.
        integral: (m,) sum of the responses to the error.
        command: (m,) u.
        saturated: (m,) beyond the limit.
        step: (2, m) response to the error, to increments.
        change: (2, m) what they respond to.
        weighted: (m, m) lambda + phi^T phi, then its factors.
        phi: (m, m) phi of the input.
        work: (m, m).
        pivots: (m,).
    """

    past: npt.NDArray[np.float64]
    proportional: npt.NDArray[np.float64]
    integral: npt.NDArray[np.float64]
    command: npt.NDArray[np.float64]
    saturated: npt.NDArray[np.bool_]
    step: npt.NDArray[np.float64]
    change: npt.NDArray[np.float64]
    weighted: npt.NDArray[np.float64]
    phi: npt.NDArray[np.float64]
    work: npt.NDArray[np.float64]
    pivots: npt.NDArray[np.int64]


def increment_memory(channels: int, outputs: int, inputs: int) -> IncrementMemory:
    """Memory for m channels, Ly and Lu."""
    return IncrementMemory(
        past=np.zeros((outputs + inputs, channels)),
        proportional=np.zeros(channels),
        integral=np.zeros(channels),
        command=np.zeros(channels),
        saturated=np.zeros(channels, dtype=bool),
        step=np.zeros((2, channels)),
        change=np.zeros((2, channels)),
        weighted=np.zeros((channels, channels)),
        phi=np.zeros((channels, channels)),
        work=np.zeros((channels, channels)),
        pivots=np.zeros(channels, dtype=np.int64),
    )


@kernel
def respond(rule: IncrementRule, memory: IncrementMemory, gradient: GradientMemory, error: Vector, dy: Vector) -> int:
    """Write the next command; returns a status.

    Args:
        rule: of the law.
        memory: read and written.
        gradient: the present Phi.
        error: (m,) y*(k+1) - y(k).
        dy: (m,) y(k) - y(k-1).
    """
    channels, outputs = error.shape[0], rule.outputs
    push(memory.past, 0, outputs, dy)
    for i in range(channels):
        total = 0.0
        for block in range(outputs + rule.inputs):
            if block != outputs:
                # Increments of the input are older by one than phi of the input, which acts on the one that is sought.
                row = memory.past[block if block < outputs else block - 1]
                total += rule.rho[block, i] * _row_times(gradient.estimate, i, channels * block, row)
        memory.change[0, i], memory.change[1, i] = rule.rho[outputs, i] * error[i], -total
        for j in range(channels):
            memory.phi[i, j] = gradient.estimate[i, channels * outputs + j]
    status = _solve(rule, memory, gradient.bounds[LEAST])
    if status == ANSWERED:
        _accumulate(rule, memory)
    return status


@inner
def _row_times(estimate: Vector, i: int, at: int, x: Vector) -> float:
    total = 0.0
    for j in range(x.shape[0]):
        total += estimate[i, at + j] * x[j]
    return total


@inner
def _solve(rule: IncrementRule, memory: IncrementMemory, least: float) -> int:
    """Both responses."""
    phi, weighted, channels = memory.phi, memory.weighted, memory.phi.shape[0]
    excess = excess_of(phi, least, memory.work)
    for i in range(channels):
        for j in range(channels):
            total = 0.0
            for k in range(channels):
                total += (phi[k, i] * rule.share[k]) * phi[k, j]
            weighted[i, j] = total
        weighted[i, i] += rule.control[0]
        weighted[i, i] += excess
        for part in range(2):
            total = 0.0
            for k in range(channels):
                total += phi[k, i] * memory.change[part, k]
            memory.step[part, i] = total
    if not factor(weighted, memory.pivots):
        return SINGULAR
    finite = True
    for part in range(2):
        solve(weighted, memory.pivots, memory.step[part])
        for i in range(channels):
            finite = finite and math.isfinite(memory.step[part, i])
    return ANSWERED if finite else UNUSABLE


@inner
def _accumulate(rule: IncrementRule, memory: IncrementMemory) -> None:
    """Integral and proportional part, the command within its limits, and its increment."""
    outputs = rule.outputs
    for i in range(memory.command.shape[0]):
        integral, limit = memory.step[0, i], rule.limit[i]
        memory.proportional[i] += memory.step[1, i]
        desired = memory.proportional[i] + memory.integral[i] + integral
        outside = abs(desired) > limit
        if not (outside and _sign(integral) == _sign(desired)):
            memory.integral[i] += integral
        command = min(max(memory.proportional[i] + memory.integral[i], -limit), limit)
        memory.change[0, i] = command - memory.command[i]
        memory.command[i], memory.saturated[i] = command, outside
    push(memory.past, outputs, rule.inputs, memory.change[0])


@inner
def _sign(x: float) -> int:
    return 1 if x > 0.0 else -1 if x < 0.0 else 0
