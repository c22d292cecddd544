"""One answer of park, from state and reference to command and telemetry; the symbols are those of ``Park``."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.rest import RestRobot, RestRoom, push_within_limits, rest_example, show_errors
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class ParkRule(NamedTuple):
    """The numbers of the law.

    Attributes:
        period: T [s].
        speed: v.
        step: A T.
        posture: (n,) q_p.
    """

    period: float
    speed: float
    step: float
    posture: npt.NDArray[np.float64]


class ParkContext(NamedTuple):
    """A law: its numbers, the nominal robot, room; whether there is a path (1,), and its p, r, next r (3, n)."""

    rule: ParkRule
    known: RestRobot
    room: RestRoom
    begun: npt.NDArray[np.int64]
    path: npt.NDArray[np.float64]


PARK = kind_of(
    ParkContext(ParkRule(1.0, 1.0, 1.0, np.zeros(1)), *rest_example(), np.zeros(1, dtype=np.int64), np.zeros((3, 1)))
)
PLACE, RATE, NEXT = range(3)


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``Park``, in its order."""
    law = loaded(context, PARK)
    rule, path, a, n, size = law.rule, law.path, law.room.acceleration, law.path.shape[1], v.shape[0]
    at = show_errors(law.room, q, v, q_d, v_d, a_d, row)
    decay = law.room.rate[0] / (1.0 + law.room.rate[0] * rule.period)
    for i in range(size):
        a[i] = -decay * v[i]
    for i in range(n):
        if not law.begun[0]:
            path[PLACE, i], path[RATE, i] = q[7 + i], v[6 + i]
        place, rate = path[PLACE, i], path[RATE, i]
        path[NEXT, i] = _next_rate(rule, rule.posture[i] - place, rate)
        change = (path[NEXT, i] - rate) / rule.period
        a[6 + i] = change + decay * (rate - v[6 + i]) + 0.25 * (decay * decay) * (place - q[7 + i])
        row[at + i], row[at + n + i], row[at + 2 * n + i] = place, rate, rule.posture[i] - q[7 + i]
    scale = push_within_limits(law.known, law.room, q, u)
    row[at + 3 * n] = scale
    law.begun[0] = 1 if scale == 1.0 else 0
    for i in range(n):
        path[PLACE, i], path[RATE, i] = path[PLACE, i] + rule.period * path[NEXT, i], path[NEXT, i]
    return ANSWERED if scale >= 0.0 else UNUSABLE


@inner
def _next_rate(rule: ParkRule, left: float, rate: float) -> float:
    """The rate of a joint after this period, for what is left of the path and the rate so far."""
    distance = abs(left)
    stopping = rule.step * (math.sqrt(0.25 + 2.0 * distance / (rule.step * rule.period)) - 0.5)
    wanted = min(min(rule.speed, stopping), distance / rule.period)
    wanted = wanted if left > 0.0 else -wanted if left < 0.0 else 0.0
    return rate + min(max(wanted - rate, -rule.step), rule.step)
