"""One answer of damped hold, from state to command and telemetry; the symbols are those of ``DampedHold``."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.mass import inertia
from space_robot_control.kernel.rest import RestRobot, RestRoom, rest_example, show_errors
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.dense import factor, largest_singular_value, solve
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class HoldWork(NamedTuple):
    """Room for one answer.

    Attributes:
        inertia: (m, m) H, then its factors.
        inverse: (m, m) H^-1.
        scaled: (m, m).
        pivots: (m,).
        moved: (m,) d.
    """

    inertia: npt.NDArray[np.float64]
    inverse: npt.NDArray[np.float64]
    scaled: npt.NDArray[np.float64]
    pivots: npt.NDArray[np.int64]
    moved: npt.NDArray[np.float64]


class HoldContext(NamedTuple):
    """A law: its period, the nominal robot, room."""

    period: float
    known: RestRobot
    room: RestRoom
    work: HoldWork


def hold_work(size: int) -> HoldWork:
    """Room for that many degrees of freedom that have an actuator."""
    square = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    return HoldWork(*square, np.zeros(size, dtype=np.int64), np.zeros(size))


HOLD = kind_of(HoldContext(1.0, *rest_example(), hold_work(1)))


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``DampedHold``, in its order."""
    law = loaded(context, HOLD)
    size, m = v.shape[0], law.work.moved.shape[0]
    at = show_errors(law.room, q, v, q_d, v_d, a_d, row)
    known, room = law.known, law.room
    if not inertia(known.robot, known.mass, known.floating, q, room.work, law.work.inertia):
        return UNUSABLE
    if not _weigh(law.work):
        return UNUSABLE
    largest, power = largest_singular_value(law.work.scaled, law.work.inertia), 0.0
    rate = room.rate[0] / (1.0 + room.rate[0] * law.period * largest)
    for i in range(size):
        damping = rate * law.work.moved[i - (size - m)] if i >= size - m else 0.0
        u[i], row[at + i] = -damping * v[i], damping
        power += v[i] * u[i]
    row[at + size] = power
    return ANSWERED


@inner
def _weigh(work: HoldWork) -> bool:
    """Write d and d^1/2 H^-1 d^1/2. False: H is not positive definite."""
    size = work.moved.shape[0]
    if not factor(work.inertia, work.pivots):
        return False
    definite = True
    for j in range(size):
        for i in range(size):
            work.inverse[j, i] = 1.0 if i == j else 0.0
        solve(work.inertia, work.pivots, work.inverse[j])
        definite = definite and work.inverse[j, j] > 0.0
        work.moved[j] = 1.0 / work.inverse[j, j]
    for i in range(size):
        for j in range(size):
            work.scaled[i, j] = math.sqrt(work.moved[i]) * work.inverse[i, j] * math.sqrt(work.moved[j])
    return definite
