"""The numbers that monitors read, and whether one of them needs a closer look: one call a tick."""

from __future__ import annotations

from math import inf, nan, sqrt
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.quaternion import attitude, relative, three
from space_robot_description.kernel.spatial import Vec, sub
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2

# What a row reads; each is explained in docs/supervision.md.
POSITION, RATE, BASE_RATE, BASE_SPEED, JOINT_RATE, MARGIN = constants(0, 1, 2, 3, 4, 5)
OFF_POSITION, OFF_ATTITUDE, OFF_JOINTS, SATURATION, WHEELS = constants(6, 7, 8, 9, 10)
COUNT, NUMBER, BLOCK = constants(11, 12, 13)
# Rows of ``values``.
BEFORE, NOW = constants(0, 1)


class Readings(NamedTuple):
    """What is read, and where the values are that need no closer look.

    Attributes:
        rows: (k, 3) kind, and where in its source a number or a block begins and ends; begin -1: there is none.
        ends: (2, n) lower and upper limit of the joints, infinite where there is none [rad or m].
        limit: (6+n,) of the actuators, infinite where there is none [N, N m].
        values: (2, k) at the tick before and now, written; not a number: there is none.
        guards: (m, 2) row, and 1 where it must change from tick to tick.
        bounds: (m, 2) from where to where nothing is the matter.
    """

    rows: npt.NDArray[np.int64]
    ends: npt.NDArray[np.float64]
    limit: npt.NDArray[np.float64]
    values: npt.NDArray[np.float64]
    guards: npt.NDArray[np.int64]
    bounds: npt.NDArray[np.float64]


def _example() -> Readings:
    numbers, places = np.zeros((1, 1)), np.zeros((1, 1), dtype=np.int64)
    return Readings(places, numbers, np.zeros(1), numbers, places, numbers)


READINGS = kind_of(_example())


@kernel
def keep(values: Readings, room: Any) -> int:
    """See ``context_of``."""
    size: int = stored(values, room)
    return size


@kernel
def read(
    address: Any,
    q: Vector,
    v: Vector,
    q_d: Vector,
    wrench: Vector,
    effort: Vector,
    telemetry: Vector,
    wheels: Vector,
    counts: Vector,
) -> int:
    """Read all rows; what is not there yet is an array of no numbers.

    Args:
        address: of the ``Readings``.
        q: (7+n,) measured.
        v: (6+n,) measured.
        q_d: (7+n,) of the reference.
        wrench: (6,) of the last command.
        effort: (n,) of the last command.
        telemetry: of the controller.
        wheels: (3,) their momentum [N m s].
        counts: (3,) of the plant's command monitor.

    Returns:
        How many guards need a closer look.
    """
    of = loaded(address, READINGS)
    values = of.values
    for row in range(of.rows.shape[0]):
        kind, begin, end = of.rows[row, 0], of.rows[row, 1], of.rows[row, 2]
        values[BEFORE, row] = values[NOW, row]
        if kind < OFF_POSITION:
            values[NOW, row] = _measured(of, kind, begin, q, v)
        elif kind < SATURATION:
            values[NOW, row] = _off(kind, q, q_d)
        elif kind == SATURATION:
            values[NOW, row] = _saturated(of.limit, wrench, effort)
        elif kind == WHEELS:
            values[NOW, row] = _norm(three(wheels, 0)) if wheels.shape[0] else nan
        elif kind == COUNT:
            values[NOW, row] = _largest(counts, begin, end)
        elif kind == NUMBER:
            values[NOW, row] = telemetry[begin] if 0 <= begin < end <= telemetry.shape[0] else nan
        else:
            values[NOW, row] = _largest(telemetry, begin, end)
    return _noticed(of)


@inner
def _noticed(of: Readings) -> int:
    noticed = 0
    for guard in range(of.guards.shape[0]):
        row = of.guards[guard, 0]
        value = of.values[NOW, row]
        if of.guards[guard, 1]:
            noticed += value == of.values[BEFORE, row]
        else:
            noticed += value < of.bounds[guard, 0] or value > of.bounds[guard, 1]
    return noticed


@inner
def _measured(of: Readings, kind: int, index: int, q: Vector, v: Vector) -> float:
    if kind == POSITION:
        return float(q[index])
    if kind == RATE:
        return float(v[index])
    if kind == BASE_RATE:
        return _norm(three(v, 3))
    if kind == BASE_SPEED:
        return _norm(three(v, 0))
    found = 0.0 if kind == JOINT_RATE else inf
    for joint in range(v.shape[0] - 6):
        if kind == JOINT_RATE:
            found = max(found, abs(v[6 + joint]))
        else:
            found = min(found, q[7 + joint] - of.ends[0, joint], of.ends[1, joint] - q[7 + joint])
    return found


@inner
def _off(kind: int, q: Vector, q_d: Vector) -> float:
    if kind == OFF_POSITION:
        return _norm(sub(three(q_d, 0), three(q, 0)))
    if kind == OFF_ATTITUDE:
        x, y, z, w = relative(attitude(q), attitude(q_d))
        return 2.0 * atan2(_norm((x, y, z)), w)
    found = 0.0
    for joint in range(7, q.shape[0]):
        found = max(found, abs(q_d[joint] - q[joint]))
    return found


@inner
def _saturated(limit: Vector, wrench: Vector, effort: Vector) -> float:
    if not wrench.shape[0]:
        return nan
    limited, full = 0, 0
    for channel in range(limit.shape[0]):
        most = limit[channel]
        u = wrench[channel] if channel < 6 else effort[channel - 6]
        if most < inf:
            limited += 1
            full += not -most < u < most
    return full / limited


@inner
def _largest(data: Vector, begin: int, end: int) -> float:
    if begin < 0 or end > data.shape[0]:
        return nan
    found = 0.0
    for place in range(begin, end):
        found = max(found, abs(data[place]))
    return found


@inner
def _norm(a: Vec) -> float:
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
