"""One answer of PD on channels, from state and reference to command and telemetry."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.kernel.gated_filter import FilterRule
from space_robot_control.kernel.sensing import SensingMemory, SensingRule, sense, sensing_memory
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.dense import solve
from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector


class PdNumbers(NamedTuple):
    """The numbers of the law.

    Attributes:
        kp: (m,) wn^2 [1/s2].
        kd: (m,) 2 zeta wn [1/s].
        factors: (m, m) of B, see ``kernel.dense.factor``.
        pivots: (m,) of B.
        response: (m,) diagonal of B.
        inputs: (m,) room for the inputs.
    """

    kp: npt.NDArray[np.float64]
    kd: npt.NDArray[np.float64]
    factors: npt.NDArray[np.float64]
    pivots: npt.NDArray[np.int64]
    response: npt.NDArray[np.float64]
    inputs: npt.NDArray[np.float64]


class PdContext(NamedTuple):
    """A law: its numbers, and what it senses."""

    sensing: SensingRule
    sensed: SensingMemory
    numbers: PdNumbers


def pd_numbers(channels: int) -> PdNumbers:
    """Room for the numbers of that many channels."""
    gains, square = (np.zeros(channels), np.zeros(channels)), np.zeros((channels, channels))
    return PdNumbers(*gains, square, np.zeros(channels, dtype=np.int64), np.zeros(channels), np.zeros(channels))


def _example() -> PdContext:
    rule = SensingRule(np.zeros(1, dtype=np.int64), 0, FilterRule(1.0, 1.0, 1.0, 0, np.zeros(1)))
    return PdContext(rule, sensing_memory(0, 1), pd_numbers(1))


PD = kind_of(_example())


@kernel
def keep(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def answer(
    context: Any,
    q: Vector,
    v: Vector,
    effort: Vector,
    acceleration: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    u: Vector,
    row: Vector,
) -> int:
    """See ``kernel.answers``; the blocks of ``row`` are those of ``ProportionalDerivative``, in its order."""
    law = loaded(context, PD)
    sensed, numbers, size, m = law.sensed, law.numbers, v.shape[0], law.sensing.dofs.shape[0]
    sense(law.sensing, sensed, q, v, q_d, v_d, a_d)
    for i in range(m):
        numbers.inputs[i] = numbers.kp[i] * sensed.error[i] + numbers.kd[i] * sensed.rate[i]
    solve(numbers.factors, numbers.pivots, numbers.inputs)
    refused = 0.0
    for i in range(size):
        u[i], row[i], row[size + i] = 0.0, sensed.now.configuration[i], sensed.now.velocity[i]
    for i in range(m):
        u[law.sensing.dofs[i]] = numbers.inputs[i]
        row[2 * size + i], row[2 * size + m + i] = sensed.error[i], sensed.rate[i]
        row[2 * size + 2 * m + 1 + i] = numbers.response[i]
        refused += sensed.filter.refused[i]
    row[2 * size + 2 * m] = refused
    return ANSWERED
