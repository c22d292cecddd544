"""The supervisor of a run, with what it needs of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from space_robot_bringup.compose.supervision import KEY
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_control.command_delay import CommandDelay
from space_robot_control.laws.base import Inbox, Law
from space_robot_control.laws.common_layout import ACTIVE, HANDOVER
from space_robot_control.laws.switching import Switching
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_control.wheel_momentum import WheelMomentum
from space_robot_description.actuation import command_limit
from space_robot_description.robot import Robot
from space_robot_msgs_py.events import LAW_FAILED, DiagnosticEvent
from space_robot_msgs_py.interfaces import (
    Acknowledgement,
    Command,
    ControlOutput,
    Reference,
    RobotState,
    Supervision,
    Vector,
)
from space_robot_sim.command_monitor import CLIPPED, MISSING, REFUSED
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.values import COUNTS, Snapshot

_COUNTED = dict(zip((MISSING, REFUSED, CLIPPED), COUNTS, strict=True))


class RunSupervisor:
    """A supervisor with what it needs of a run: its links, the wheels' momentum, the counts of the plant's monitor.

    Args:
        supervisor: decides.
        robot: the NOMINAL robot.
        control_period: [s].
        inbox: what stands between the messages and it; None: nothing.
    """

    def __init__(self, supervisor: Supervisor, robot: Robot, control_period: float, inbox: Inbox | None) -> None:
        self._supervisor, self._robot, self._seconds, self._inbox = supervisor, robot, control_period, inbox
        self._counts_wheels, self._wheels = supervisor.counts_wheels, WheelMomentum(robot)
        self.reset()

    @property
    def reads_telemetry(self) -> bool:
        """It needs the controller's telemetry."""
        return self._supervisor.reads_telemetry

    @property
    def reads_counts(self) -> bool:
        """It needs the events of the plant's command monitor."""
        return self._supervisor.reads_counts

    def reset(self) -> None:
        """Forget the past; the next update is the first of a run."""
        self._supervisor.reset()
        self._wheels = self._wheels.at_start()
        self._line = CommandDelay(self._robot.command_delay, none=False)
        self._counts: Counter[str] = Counter()
        self._noted = -1

    def order(self, command: str) -> Acknowledgement:
        """Take a command of the ground, which acts at the next update."""
        return self._supervisor.order(command)

    def update(
        self,
        state: RobotState,
        reference: Reference,
        answer: ControlOutput | None = None,
        events: Sequence[DiagnosticEvent] = (),
    ) -> Supervision:
        """Look at one tick and decide; see ``SupervisorUnit``."""
        if self._inbox is not None:
            state, reference, _ = self._inbox.hear(state, reference)
        for event in events:
            if event.name in _COUNTED:
                self._counts[_COUNTED[event.name]] += 1
        command, telemetry = (None, None) if answer is None else (answer.command, answer.telemetry)
        wheels = self._momentum(state, command) if self._counts_wheels else None
        return self._supervisor.update(Snapshot(state, reference, command, telemetry, wheels, self._counts))

    def _momentum(self, state: RobotState, command: Command | None) -> Vector:
        """Of the wheels at this state, after the last command."""
        if command is not None and command.stamp > self._noted:
            self._noted = command.stamp
            self._wheels.apply(self._line.acting(command, True)[0].u, self._seconds)
        self._wheels.measure(state.wheel_momentum)
        return self._wheels.numbers.momentum


def run_supervisor(experiment: Experiment, robot: Robot, controller: Law, inbox: Inbox | None) -> RunSupervisor:
    """The supervisor of an experiment with a supervision table.

    Args:
        experiment: it has one.
        robot: the NOMINAL robot.
        controller: that it watches, for the labels of its telemetry.
        inbox: of its links.

    Raises:
        SpecError: a monitor reads what there is not.
    """
    table = experiment.supervision
    assert table is not None
    assert isinstance(controller, Switching)
    labels = [*ERROR_FIELDS, ACTIVE, HANDOVER, *([] if table.fallback is None else [LAW_FAILED])]
    for name, law in controller.laws.items():
        labels += [f"{name}.{label}" for label in law.telemetry_fields if label not in ERROR_FIELDS]
    counted = getattr(experiment.plant, "monitor", None) is not None
    supervisor = Supervisor(table, robot, labels, command_limit(robot), KEY, counted=counted)
    return RunSupervisor(supervisor, robot, experiment.control_period, inbox)
