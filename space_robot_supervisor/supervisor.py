"""The supervisor: looks at every tick, reports what it finds, decides on the mode; no clock, no memory but its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from space_robot_description.robot import Robot
from space_robot_msgs_py.events import ERROR, OK, WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Reference, Vector
from space_robot_supervisor.monitors import Monitor
from space_robot_supervisor.table import SEVERITIES, ModeSpec, Severity, SupervisionTable
from space_robot_supervisor.values import Snapshot, value_of

LEVELS: dict[Severity, int] = {"info": OK, "low": WARN, "medium": WARN, "high": ERROR}
# Name of the events of a change of mode.
MODE = "mode"


@dataclass(frozen=True, eq=False, slots=True)
class Supervision:
    """What holds from a tick on.

    Attributes:
        mode: name of the mode.
        reference: what the law of this mode is to follow, of the stamp of the tick.
        events: what was found at this tick.
    """

    mode: str
    reference: Reference
    events: tuple[DiagnosticEvent, ...]


class Supervisor:
    """Monitors and modes of one run.

    Args:
        table: checked, see ``SupervisionTable.check``.
        robot: the NOMINAL robot.
        labels: of the controller's telemetry.
        limit: (6+n,) of its actuators.
        key: of the table, for errors.

    Attributes:
        mode: name of the mode.

    Raises:
        SpecError: a monitor reads what there is not.
    """

    def __init__(
        self, table: SupervisionTable, robot: Robot, labels: Sequence[str], limit: Vector, key: str = "supervision"
    ) -> None:
        self._table = table
        self._monitors = [
            Monitor(row, value_of(row.value, robot, labels, limit, f"{key}.monitors.{index}.value"))
            for index, row in enumerate(table.monitors)
        ]
        self.reset()

    def reset(self) -> None:
        """Back to the first mode; the next tick is the first of a run."""
        self.mode, self._entered = self._table.start, False
        for monitor in self._monitors:
            monitor.reset()

    @property
    def active(self) -> ModeSpec:
        """What runs in the mode."""
        return self._table.modes[self.mode]

    def update(self, now: Snapshot) -> Supervision:
        """Look at one tick and decide.

        Every monitor of the mode looks; of those that fire and lead somewhere the one of the highest severity decides,
        of equal ones the first of the table. At most one change of mode a tick.
        """
        if not self._entered:
            self._enter(now)
        events, leading = [], None
        for monitor in self._monitors:
            if self.mode not in self._table.modes_of(monitor.spec):
                continue
            edge = monitor.look(now)
            if edge is None:
                continue
            events.append(_event(now.state.stamp, monitor, edge))
            if edge == "fires" and monitor.spec.to is not None and _outranks(monitor, leading):
                leading = monitor
        if leading is not None:
            events.append(self._change(now, leading))
        return Supervision(self.mode, self._reference(now.reference), tuple(events))

    def _change(self, now: Snapshot, cause: Monitor) -> DiagnosticEvent:
        before, self.mode = self.mode, str(cause.spec.to)
        self._enter(now)
        values = (("from", before), ("to", self.mode), ("cause", cause.spec.name))
        level = LEVELS[cause.spec.severity]
        return DiagnosticEvent(now.state.stamp, level, MODE, f"{before} -> {self.mode}", "", values)

    def _enter(self, now: Snapshot) -> None:
        self._entered = True
        self._frozen = now.state.q if self.active.reference == "here" else now.reference.q
        for monitor in self._monitors:
            monitor.enter()

    def _reference(self, reference: Reference) -> Reference:
        if self.active.reference == "follow":
            return reference
        still = np.zeros(reference.v.size)
        return Reference(reference.stamp, self._frozen, still, still)


def _outranks(monitor: Monitor, leading: Monitor | None) -> bool:
    if leading is None:
        return True
    return SEVERITIES.index(monitor.spec.severity) > SEVERITIES.index(leading.spec.severity)


def _event(stamp: int, monitor: Monitor, edge: str) -> DiagnosticEvent:
    spec = monitor.spec
    bounds = [
        (name, repr(bound)) for name, bound in (("above", spec.above), ("below", spec.below)) if bound is not None
    ]
    values = (("value", spec.value), ("is", repr(monitor.seen)), *bounds, ("severity", spec.severity))
    level = LEVELS[spec.severity] if edge == "fires" else OK
    return DiagnosticEvent(stamp, level, spec.name, edge, "", values)
