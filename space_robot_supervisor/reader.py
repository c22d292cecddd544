"""Reads the values of a mode at once, and says whether one of them needs a closer look."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isnan

import numpy as np

from space_robot_description.kernel.context import context_of
from space_robot_description.kernel.jit import bound
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector
from space_robot_supervisor.kernel.readings import BEFORE, NOW, Readings, keep, read
from space_robot_supervisor.rows import MonitorSpec
from space_robot_supervisor.values import Snapshot, Value, counts_of

_NONE = np.empty(0)


class Reader:
    """Some values of one robot.

    Args:
        values: each once.
        robot: the NOMINAL robot.
        limit: (6+n,) of its actuators, infinite where there is none.
        guards: place of a value and the condition on it.
    """

    def __init__(
        self, values: Sequence[Value], robot: Robot, limit: Vector, guards: Sequence[tuple[int, MonitorSpec]] = ()
    ) -> None:
        self._values = tuple(values)
        self._labels: tuple[str, ...] = ()
        conditions = [
            (-inf if one.below is None else one.below, inf if one.above is None else one.above) for _, one in guards
        ]
        numbers = Readings(
            np.array([value.row(None) for value in values], dtype=np.int64).reshape(-1, 3),
            np.vstack([robot.joint_lower, robot.joint_upper]).astype(np.float64).reshape(2, -1),
            np.array(limit, dtype=np.float64),
            np.full((2, len(values)), np.nan),
            np.array([(place, one.unchanged) for place, one in guards], dtype=np.int64).reshape(-1, 2),
            np.array(conditions, dtype=np.float64).reshape(-1, 2),
        )
        self._numbers, self._context = numbers, context_of(numbers, keep)
        self._counted = any(value.of_counts for value in values)
        n = robot.n
        example = np.zeros(7 + n), np.zeros(6 + n), np.zeros(7 + n)
        self._read = bound(read, self._context.address, *example, _NONE, _NONE, _NONE, _NONE, _NONE)

    def read(self, now: Snapshot) -> int:
        """Read all values of a tick; how many conditions need a closer look."""
        state, reference, command, telemetry, wheels, counts = now
        if telemetry is not None and telemetry.labels is not self._labels:
            # Found once: labels and sizes stay the same for a whole run.
            self._labels = telemetry.labels
            for place, value in enumerate(self._values):
                self._numbers.rows[place] = value.row(telemetry)
        return self._read(
            self._context.address,
            state.q,
            state.v,
            reference.q,
            _NONE if command is None else command.wrench,
            _NONE if command is None else command.effort,
            _NONE if telemetry is None else telemetry.data,
            _NONE if wheels is None else wheels,
            counts_of(counts) if self._counted and counts is not None else _NONE,
        )

    @property
    def found(self) -> list[tuple[float | None, float | None]]:
        """Of each value what it was at the tick before and is now; None: there was none."""
        before, now = self._numbers.values[BEFORE].tolist(), self._numbers.values[NOW].tolist()
        return [(_there(a), _there(b)) for a, b in zip(before, now, strict=True)]

    def forget(self) -> None:
        """Nothing was read before."""
        self._numbers.values[:] = np.nan


def _there(value: float) -> float | None:
    return None if isnan(value) else value
