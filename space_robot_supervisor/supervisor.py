"""The supervisor: looks at every tick, reports what it finds, decides on the mode; no clock, no memory but its own."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_description.robot import Robot
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.interfaces import NANOSECONDS, Acknowledgement, Supervision, Telemetry, Vector
from space_robot_supervisor import reports
from space_robot_supervisor.monitors import Monitor
from space_robot_supervisor.plan import Plan
from space_robot_supervisor.reader import Reader
from space_robot_supervisor.rows import COMMANDS, SEVERITIES, Severity
from space_robot_supervisor.table import SupervisionTable, mode_of
from space_robot_supervisor.values import TELEMETRY, Snapshot, Value, value_of


class Supervisor:
    """Monitors, modes, commands and plans of one run.

    Args:
        table: checked, see ``SupervisionTable.check``.
        robot: the NOMINAL robot.
        labels: of the controller's telemetry.
        limit: (6+n,) of its actuators.
        key: of the table, for errors.
        counted: the plant's command monitor counts.

    Attributes:
        mode: name of the mode.

    Raises:
        SpecError: a monitor, or the housekeeping, reads what there is not.
    """

    def __init__(
        self,
        table: SupervisionTable,
        robot: Robot,
        labels: Sequence[str],
        limit: Vector,
        key: str = "supervision",
        *,
        counted: bool = False,
    ) -> None:
        self._table, summary = table, table.housekeeping
        named = [(row.value, f"{key}.monitors.{index}.value") for index, row in enumerate(table.monitors)]
        if summary is not None:
            named += [(name, f"{key}.housekeeping.values.{index}") for index, name in enumerate(summary.values)]
        self._values: dict[str, Value] = {}
        for name, place in named:
            self._values[name] = value_of(name, robot, labels, place, counted=counted)
        self._every = 0 if summary is None else round(summary.period * NANOSECONDS)
        self._monitors = [Monitor(row) for row in table.monitors]
        self._watched = {mode: self._watch(mode, robot, limit) for mode in table.modes}
        summed = () if summary is None else summary.values
        self._summary = Reader([self._values[name] for name in summed], robot, limit)
        self._plan, self._calm = Plan(table), True
        self.reset()

    @property
    def reads_telemetry(self) -> bool:
        """It needs the controller's telemetry."""
        return any(name.startswith(TELEMETRY) for name in self._values)

    @property
    def reads_counts(self) -> bool:
        """It needs the counts of the plant's command monitor."""
        return any(value.of_counts for value in self._values.values())

    @property
    def counts_wheels(self) -> bool:
        """It needs the momentum of the wheels."""
        return any(value.of_wheels for value in self._values.values())

    def reset(self) -> None:
        """Back to the first mode; the next tick is the first of a run."""
        self._orders: list[tuple[str, Acknowledgement]] = []
        self._plan.reset()
        self._planned = not self._plan.idle
        for monitor in self._monitors:
            monitor.reset()
        self._found: list[DiagnosticEvent] = []
        self._reported = 0
        self._enter(self._table.start, 0)

    def order(self, command: str) -> Acknowledgement:
        """Take a command of the ground; accepted or refused, it has an event at the next tick, at which it acts."""
        mode = next((mode_of(name) for name, said in reversed(self._orders) if said.accepted), self.mode)
        said = self._judge(command, mode)
        self._orders.append((command, said))
        return said

    def update(self, now: Snapshot) -> Supervision:
        """Look at one tick and decide.

        Commands of the ground come first, then what is planned, then the monitors: of those that fire and lead
        somewhere the one of the highest severity decides, of equal ones the first of the table. Where a command or a
        plan changes the mode the monitors begin at the tick after.
        """
        stamp = now.state.stamp
        changed = bool(self._orders) and self._obey(stamp)
        if self._planned:
            changed |= self._follow_plan(stamp)
        if not changed:
            self._look(now)
        summary = self._sum_up(now) if self._every and stamp % self._every == 0 else None
        events: tuple[DiagnosticEvent, ...] = ()
        if self._found:
            events, self._found = tuple(self._found), []
            self._reported += len(events)
        answer = -1 if now.command is None else now.command.stamp
        said = self._law, self._policy, self._since, answer, events, summary
        return Supervision(stamp, self.mode, *said, self._brakes, self._unload)

    def _watch(self, mode: str, robot: Robot, limit: Vector) -> tuple[Reader, list[tuple[Monitor, int]]]:
        """What is read in a mode, each value once, and which monitors look at which of them."""
        watching = [one for one in self._monitors if mode in self._table.modes_of(one.spec)]
        names = list(dict.fromkeys(one.spec.value for one in watching))
        places = [(one, names.index(one.spec.value)) for one in watching]
        guards = [(place, one.spec) for one, place in places]
        return Reader([self._values[name] for name in names], robot, limit, guards), places

    def _look(self, now: Snapshot) -> None:
        # Nearly always nothing is the matter, and that is all there is to do.
        if self._reader.read(now) or not self._calm:
            self._look_closer(now)
            self._calm = all(monitor.calm for monitor, _ in self._watching)

    def _look_closer(self, now: Snapshot) -> None:
        values = self._reader.found
        leading: Monitor | None = None
        for monitor, place in self._watching:
            edge = monitor.look(*values[place])
            if edge is None:
                continue
            self._found.append(reports.edge(now.state.stamp, monitor, edge))
            if edge == "clears":
                continue
            if monitor.spec.to is not None and (leading is None or _rank(monitor) > _rank(leading)):
                leading = monitor
            if monitor.spec.start is not None:
                self._start(monitor.spec.start, now.state.stamp, monitor.spec.name)
        if leading is not None:
            self._change(now.state.stamp, str(leading.spec.to), leading.spec.name, leading.spec.severity)

    def _obey(self, stamp: int) -> bool:
        """Carry out the commands of the ground; whether the mode has changed."""
        orders, self._orders, changed = self._orders, [], False
        for command, said in orders:
            changed |= self._execute(stamp, command, said, reports.GROUND)
        return changed

    def _follow_plan(self, stamp: int) -> bool:
        changed = False
        for step in self._plan.due(stamp):
            if step.start:
                self._start(step.start, stamp, step.by)
                continue
            said = self._judge(step.command, self.mode)
            changed |= self._execute(stamp, step.command, said, step.by)
            if step.by in self._plan.running and (step.last or not said.accepted):
                self._stop(step.by, stamp, "ends" if said.accepted else "aborted")
        self._planned = not self._plan.idle
        return changed

    def _judge(self, command: str, mode: str) -> Acknowledgement:
        """Whether a command may act in a mode."""
        target = mode_of(command)
        if command not in COMMANDS or target not in self._table.modes:
            return Acknowledgement(False, f"the table has no mode {target}")
        if target == mode:
            return Acknowledgement(False, f"in {mode} already")
        allowed = self._table.modes[target].from_
        if allowed and mode not in allowed:
            return Acknowledgement(False, f"not from {mode}, but from {', '.join(allowed)}")
        return Acknowledgement(True, f"from {mode} to {target} at the next tick")

    def _execute(self, stamp: int, command: str, said: Acknowledgement, by: str) -> bool:
        self._found.append(reports.command(stamp, command, said, by))
        if said.accepted:
            self._change(stamp, mode_of(command), by, "info")
        return said.accepted

    def _change(self, stamp: int, mode: str, cause: str, severity: Severity) -> None:
        self._found.append(reports.mode(stamp, self.mode, mode, cause, severity))
        # What was planned in the mode before may be wrong in another one.
        for name in self._plan.running:
            if name != cause and self._plan.begun(name) != stamp:
                self._stop(name, stamp, "aborted")
        self._enter(mode, stamp)

    def _start(self, name: str, stamp: int, cause: str) -> None:
        self._plan.start(name, stamp)
        self._planned = True
        self._found.append(reports.sequence(stamp, name, "starts", cause))

    def _stop(self, name: str, stamp: int, how: str) -> None:
        self._plan.stop(name)
        self._found.append(reports.sequence(stamp, name, how, ""))

    def _enter(self, mode: str, stamp: int) -> None:
        self.mode, self._since, spec = mode, stamp, self._table.modes[mode]
        self._law, self._policy, self._brakes, self._unload = spec.law, spec.reference, spec.brakes, spec.unload
        self._reader, self._watching = self._watched[mode]
        self._reader.forget()
        for monitor in self._monitors:
            monitor.enter()
        self._calm = all(monitor.calm for monitor, _ in self._watching)

    def _sum_up(self, now: Snapshot) -> Telemetry:
        assert self._table.housekeeping is not None
        place = float(list(self._table.modes).index(self.mode))
        self._summary.read(now)
        found = zip(self._table.housekeeping.values, self._summary.found, strict=True)
        # A number that is not there yet is a block without any.
        blocks = {name: [] if number is None else [number] for name, (_, number) in found}
        count = float(self._reported + len(self._found))
        return Telemetry.of(now.state.stamp, {"mode": place, "events": count, **blocks})


def _rank(monitor: Monitor) -> int:
    return SEVERITIES.index(monitor.spec.severity)
