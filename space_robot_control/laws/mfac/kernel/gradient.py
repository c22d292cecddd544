"""Estimator (17) of the pseudo-partial derivative; the equations are those of ``PseudoGradient``.

Reference: [Song et al. 2023, (15), (17)].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector

# A regressor whose squared norm is less carries no information (in the units of outputs and inputs).
MIN_NORM_SQUARED = 1e-12


class GradientRule(NamedTuple):
    """The numbers of the estimator: Ly, Lu, sigma, beta."""

    outputs: int
    inputs: int
    sigma: float
    beta: float


class GradientMemory(NamedTuple):
    """The estimate and what it is made from.

    Attributes:
        estimate: (m, m (Ly+Lu)) Phi.
        first: (m, m (Ly+Lu)) Phi(1).
        back: (m, m) inverse of phi_{Ly+1}(1).
        bounds: (2,) share of Phi(1) below which the estimate is reset, least singular value that is believed.
        past: (Ly+Lu, m) increments of the outputs, the newest first, then those of the inputs.
        innovation: (m,) dy - Phi dH.
        resets: (1,) so far.
    """

    estimate: npt.NDArray[np.float64]
    first: npt.NDArray[np.float64]
    back: npt.NDArray[np.float64]
    bounds: npt.NDArray[np.float64]
    past: npt.NDArray[np.float64]
    innovation: npt.NDArray[np.float64]
    resets: npt.NDArray[np.int64]


FLOOR, LEAST = range(2)


def gradient_memory(channels: int, outputs: int, inputs: int) -> GradientMemory:
    """Memory for m channels, Ly and Lu."""
    blocks = outputs + inputs
    wide = np.zeros((channels, channels * blocks)), np.zeros((channels, channels * blocks))
    back, past = np.zeros((channels, channels)), np.zeros((blocks, channels))
    return GradientMemory(*wide, back, np.zeros(2), past, np.zeros(channels), np.zeros(1, dtype=np.int64))


@kernel
def learn(rule: GradientRule, memory: GradientMemory, dy: Vector, du: Vector) -> None:
    """Update Phi by one period.

    Args:
        rule: of the estimator.
        memory: read and written.
        dy: (m,) increment of the outputs over the period that just ended.
        du: (m,) increment of the inputs at its beginning.
    """
    channels, past = dy.shape[0], memory.past
    push(past, rule.outputs, rule.inputs, du)
    size = 0.0
    for block in range(past.shape[0]):
        for j in range(channels):
            size += past[block, j] * past[block, j]
    for i in range(channels):
        memory.innovation[i] = dy[i] - times(memory.estimate, i, past, 0, past.shape[0], 0)
    if rule.sigma != 0.0 and not size < MIN_NORM_SQUARED:
        _correct(rule, memory, size)
    push(past, 0, rule.outputs, dy)


@kernel
def pass_over(rule: GradientRule, memory: GradientMemory, du: Vector) -> None:
    """Pass over a period whose increment of the outputs is not known or not due to ``du`` (m,)."""
    push(memory.past, rule.outputs, rule.inputs, du)
    push(memory.past, 0, rule.outputs, memory.past[0])


@kernel
def foresee(rule: GradientRule, memory: GradientMemory, du: Vector, dy: Vector) -> None:
    """Write the dy(k+1) (m,) that an increment du(k) (m,) of the inputs leads to."""
    channels, outputs = du.shape[0], rule.outputs
    for i in range(channels):
        total = times(memory.estimate, i, memory.past, 0, outputs, 0)
        for j in range(channels):
            total += memory.estimate[i, channels * outputs + j] * du[j]
        dy[i] = total + times(memory.estimate, i, memory.past, outputs, outputs + rule.inputs - 1, 1)


@inner
def times(estimate: Vector, i: int, past: Vector, begin: int, end: int, later: int) -> float:
    """Row ``i`` of Phi times increments from ``begin`` to ``end``, by blocks so many places later."""
    channels, total = past.shape[1], 0.0
    for block in range(begin, end):
        for j in range(channels):
            total += estimate[i, channels * (block + later) + j] * past[block, j]
    return total


@inner
def push(past: Vector, first: int, count: int, new: Vector) -> None:
    """Put an increment before the others of its kind, which forget their oldest."""
    for row in range(first + count - 1, first, -1):
        for j in range(new.shape[0]):
            past[row, j] = past[row - 1, j]
    for j in range(new.shape[0]):
        past[first, j] = new[j]


@inner
def _correct(rule: GradientRule, memory: GradientMemory, size: float) -> None:
    """Correct Phi along the regressor; back to Phi(1) where phi of the input loses its direction."""
    channels, blocks, lost = memory.innovation.shape[0], memory.past.shape[0], False
    for i in range(channels):
        share = 0.0
        for block in range(blocks):
            for j in range(channels):
                at = channels * block + j
                change = rule.sigma * (memory.innovation[i] * memory.past[block, j]) / (rule.beta + size)
                memory.estimate[i, at] += change
                lost = lost or not math.isfinite(memory.estimate[i, at])
        for j in range(channels):
            share += memory.estimate[i, channels * rule.outputs + j] * memory.back[j, i]
        lost = lost or share < memory.bounds[FLOOR]
    if lost:
        memory.resets[0] += 1
        for i in range(channels):
            for at in range(channels * blocks):
                memory.estimate[i, at] = memory.first[i, at]
