"""One answer of linear MPC where no limit is met within its horizon; where one is, it takes a solver."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.laws.lqr.kernel.design import RegulatorRule
from space_robot_control.laws.lqr.kernel.regulator import RegulatorMemory, regulate, regulator_example, show
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector

LIMITED = 4


class LimitRule(NamedTuple):
    """Limits of a period's inputs, w of the wheels.

    Attributes:
        limit: (m,) of force, torque and effort, infinite where there is none [N, N m].
        share: (w, m) of the inputs in the torque of each wheel.
        wheel: (w,) its limit [N m].
    """

    limit: npt.NDArray[np.float64]
    share: npt.NDArray[np.float64]
    wheel: npt.NDArray[np.float64]


class PredictiveContext(NamedTuple):
    """A law: its numbers, its memory, the nominal robot, its limits."""

    rule: RegulatorRule
    memory: RegulatorMemory
    robot: RobotArrays
    limits: LimitRule


PREDICTIVE = kind_of(PredictiveContext(*regulator_example(), LimitRule(np.zeros(1), np.zeros((1, 1)), np.zeros(1))))


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``LinearMpc``, in its order.

    LIMITED: the inputs without limits do not fit; u is the feed-forward, and ``x`` and the design are there.
    """
    law = loaded(context, PREDICTIVE)
    status: int = regulate(law.rule, law.memory, law.robot, q, v, wheels, q_d, v_d, a_d, u)
    if status != ANSWERED:
        return status
    if not _fits(law.rule, law.memory, law.limits, u):
        return LIMITED
    at = show(law.rule, law.memory, u, row)
    row[at], row[at + 1] = 0.0, 0.0
    return ANSWERED


@inner
def _fits(rule: RegulatorRule, memory: RegulatorMemory, limits: LimitRule, u: Vector) -> bool:
    """True if all inputs of the horizon are within the limits together with the feed-forward u (6+n,)."""
    m, fits = rule.effort.shape[0], True
    first = u.shape[0] - m
    for i in range(m):
        there = u[first + i]
        low, high = (-limits.limit[i] - there) / rule.effort[i], (limits.limit[i] - there) / rule.effort[i]
        for at in range(i, memory.z.shape[0], m):
            fits = fits and low <= memory.z[at] <= high
    for w in range(limits.wheel.shape[0]):
        there = 0.0
        for i in range(m):
            there += limits.share[w, i] * u[first + i]
        for at in range(0, memory.z.shape[0], m):
            torque = 0.0
            for i in range(m):
                torque += limits.share[w, i] * rule.effort[i] * memory.z[at + i]
            fits = fits and -limits.wheel[w] - there <= torque <= limits.wheel[w] - there
    return fits
