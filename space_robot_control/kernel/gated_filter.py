"""A filter behind a gate, channel by channel; the equations are those of ``GatedFilter``."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class FilterRule(NamedTuple):
    """The numbers of a filter.

    Attributes:
        period: T [s].
        g: share of the innovation that the value takes.
        h: share of it that the rate takes [1/s].
        patience: refusals in a row before a channel restarts.
        gate: (m,) largest credible innovation.
    """

    period: float
    g: float
    h: float
    patience: int
    gate: npt.NDArray[np.float64]


class FilterMemory(NamedTuple):
    """What a filter remembers, (m,) each: see ``GatedFilter``; ``in_a_row`` is infinite before the first sample."""

    value: npt.NDArray[np.float64]
    rate: npt.NDArray[np.float64]
    sample: npt.NDArray[np.float64]
    refused: npt.NDArray[np.float64]
    in_a_row: npt.NDArray[np.float64]
    missing: npt.NDArray[np.bool_]


def filter_memory(channels: int) -> FilterMemory:
    """Memory for that many channels, before their first sample."""
    return FilterMemory(
        value=np.zeros(channels),
        rate=np.zeros(channels),
        sample=np.zeros(channels),
        refused=np.zeros(channels),
        in_a_row=np.full(channels, np.inf),
        missing=np.zeros(channels, dtype=bool),
    )


def restart_filter(memory: FilterMemory) -> None:
    """Forget the past."""
    for array in memory:
        array[:] = 0.0
    memory.in_a_row[:] = np.inf


@kernel
def filter_samples(rule: FilterRule, memory: FilterMemory, sample: Vector, jump: Vector) -> None:
    """Take one sample (m,) per period; ``jump`` (m,) is by how much the quantity is known to have jumped since."""
    for i in range(sample.shape[0]):
        filter_channel(rule, memory, i, sample[i], jump[i])


@inner
def filter_channel(rule: FilterRule, memory: FilterMemory, i: int, sample: float, jump: float) -> None:
    """``filter_samples`` of one channel."""
    predicted = memory.value[i] + rule.period * memory.rate[i] + jump
    finite = math.isfinite(sample)
    innovation = (sample if finite else predicted) - predicted
    restart = finite and memory.in_a_row[i] >= rule.patience
    taken = finite and not restart and abs(innovation) <= rule.gate[i]
    missing = not (taken or restart)
    memory.missing[i] = missing
    memory.sample[i] = predicted + (0.0 if missing else innovation)
    memory.value[i] = predicted + (innovation if restart else rule.g * innovation if taken else 0.0)
    memory.rate[i] = 0.0 if restart else memory.rate[i] + (rule.h * innovation if taken else 0.0)
    # Before its first finite sample a channel has refused nothing, it has not begun.
    if missing and math.isfinite(memory.in_a_row[i]):
        memory.refused[i] += 1.0
    memory.in_a_row[i] = memory.in_a_row[i] + 1.0 if missing else 0.0
