"""One answer of detumble, from state and reference to command and telemetry; the symbols are those of ``Detumble``."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.rest import RestRobot, RestRoom, push_within_limits, rest_example, show_errors
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector


class DetumbleContext(NamedTuple):
    """A law: its period, the nominal robot, room; whether it has begun (1,), and the joints (n,) it began with."""

    period: float
    known: RestRobot
    room: RestRoom
    begun: npt.NDArray[np.int64]
    shape: npt.NDArray[np.float64]


DETUMBLE = kind_of(DetumbleContext(1.0, *rest_example(), np.zeros(1, dtype=np.int64), np.zeros(1)))


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``Detumble``, in its order."""
    law = loaded(context, DETUMBLE)
    n, size, a = law.shape.shape[0], v.shape[0], law.room.acceleration
    if not law.begun[0]:
        for i in range(n):
            law.shape[i] = q[7 + i]
        law.begun[0] = 1
    at = show_errors(law.room, q, v, q_d, v_d, a_d, row)
    decay = law.room.rate[0] / (1.0 + law.room.rate[0] * law.period)
    for i in range(size):
        a[i] = -decay * v[i]
    for i in range(n):
        offset = q[7 + i] - law.shape[i]
        a[6 + i] -= 0.25 * (decay * decay) * offset
        row[at + i] = offset
    scale = push_within_limits(law.known, law.room, q, u)
    row[at + n] = scale
    return ANSWERED if scale >= 0.0 else UNUSABLE
