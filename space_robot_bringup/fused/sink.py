"""What a compiled run leaves: arrays over time, and ticks where somewhere they are needed one by one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from space_robot_bringup.fused.kernel.records import Desired, Records
from space_robot_msgs_py.interfaces import (
    NANOSECONDS,
    Command,
    ControlOutput,
    PlantSample,
    Reference,
    RobotState,
    Telemetry,
    Tick,
    Vector,
)
from space_robot_msgs_py.log.arrays import LogArrays

Labels = tuple[tuple[str, ...], tuple[int, ...]]


@dataclass(eq=False)
class FusedRun:
    """A completed run, as a ``MemorySink`` of the same run would hold it.

    Attributes:
        records: tick by tick.
        desired: the reference, tick by tick.
        period: control period [ns].
        plant: labels and sizes of the plant's telemetry.
        law: labels and sizes of the law's telemetry.
        unanswered: None.
        end_reason: ``completed``.
    """

    records: Records
    desired: Desired
    period: int
    plant: Labels
    law: Labels
    unanswered: None = None
    end_reason: str = "completed"

    @cached_property
    def ticks(self) -> list[Tick]:
        """All ticks."""
        return [self._tick(index) for index in range(len(self.desired.q))]

    @cached_property
    def arrays(self) -> LogArrays:
        """The ticks as a log of them would give them."""
        records, desired = self.records, self.desired
        n, measured = records.effort.shape[1], self._measured
        stamp = np.arange(len(desired.q), dtype=np.int64) * self.period
        return LogArrays(
            stamp=stamp,
            time=stamp / NANOSECONDS,
            q=measured[:, : 7 + n],
            v=measured[:, 7 + n : 13 + 2 * n],
            effort=records.effort,
            base_acceleration=measured[:, 13 + 2 * n :],
            q_d=desired.q,
            v_d=desired.v,
            a_d=desired.a,
            wrench=records.command[:, :6],
            effort_command=records.command[:, 6:],
            controller=_blocks(self.law, records.law),
            plant=_blocks(self.plant, records.plant),
        )

    @property
    def _measured(self) -> Vector:
        return self.records.measured if len(self.records.measured) == len(self.desired.q) else self.records.truth

    def _tick(self, index: int) -> Tick:
        records, desired, stamp = self.records, self.desired, index * self.period
        n, row = records.effort.shape[1], self._measured[index]
        q, v, acceleration = row[: 7 + n], row[7 + n : 13 + 2 * n], row[13 + 2 * n :]
        state = RobotState(stamp, q, v, records.effort[index], acceleration)
        command = Command(stamp, records.command[index, :6], records.command[index, 6:])
        return Tick(
            PlantSample(state, Telemetry(stamp, *self.plant, records.plant[index])),
            Reference(stamp, desired.q[index], desired.v[index], desired.a[index]),
            ControlOutput(command, Telemetry(stamp, *self.law, records.law[index])),
        )


def _blocks(layout: Labels, rows: Vector) -> dict[str, Vector]:
    labels, sizes = layout
    edges = np.cumsum((0, *sizes)).tolist()
    return {label: rows[:, a:b] for label, (a, b) in zip(labels, pairwise(edges), strict=True)}
