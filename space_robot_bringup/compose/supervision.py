"""A supervised controller, whose law and reference follow the mode, and the supervisor that decides on the mode."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.timebase import to_nanoseconds
from space_robot_control.command_delay import CommandDelay
from space_robot_control.laws.base import Inbox, Law
from space_robot_control.laws.policy import LawPolicy
from space_robot_control.laws.registry import BUILT_IN, make_law
from space_robot_control.laws.switching import ACTIVE, HANDOVER, Switching
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_control.wheel_momentum import WheelMomentum
from space_robot_description.actuation import command_limit
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
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
from space_robot_supervisor.rows import CONTROLLER, REFERENCES
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.values import COUNTS, Snapshot

KEY = "supervision"
# Stands by where no mode has a law of its own: who switches needs two.
IDLE = "idle"
_COUNTED = dict(zip((MISSING, REFUSED, CLIPPED), COUNTS, strict=True))


class ModeController(Switching):
    """Laws that take turns as a supervisor decides, each with the reference of its mode.

    Before a supervisor has decided anything the law of the experiment follows guidance.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        laws: of the experiment first, then of the modes, by the modes' names.
        modes: by the name of a mode that has a law of its own the name of that law.
        handover: see ``Switching``.
        forgetful: modes in which a law that takes over has forgotten what it learned.
        fallback: mode whose law answers where that of the experiment cannot; None: its error ends the run.
    """

    def __init__(
        self,
        robot: Robot,
        control_period: float,
        laws: Mapping[str, Law],
        *,
        modes: Mapping[str, str],
        handover: float,
        forgetful: Collection[str] = (),
        fallback: str | None = None,
    ) -> None:
        self._first_law, self._mode_laws = next(iter(laws)), dict(modes)
        self._forgetful, self._fallback = frozenset(forgetful), fallback
        self._mark_labels = () if fallback is None else (LAW_FAILED,)
        self._decision: Supervision | None = None
        super().__init__(robot, control_period, laws, handover=handover)

    def reset(self) -> None:
        """Back to the law of the experiment; all laws are reset."""
        super().reset()
        self._held: tuple[str, int, Reference] | None = None
        self._failed = False

    def check_decision(self, decision: Supervision) -> None:
        """Refuse what this controller does not have.

        Raises:
            SpecError: such a law for such a mode, or such a reference.
        """
        if decision.law != CONTROLLER and self._mode_laws.get(decision.mode) != decision.law:
            accepted = ", ".join((CONTROLLER, *(f"{law} in {mode}" for mode, law in self._mode_laws.items())))
            said = f"{decision.law} in {decision.mode}"
            raise SpecError("no such law of a mode", key="supervisor/mode.law", value=said, accepted=accepted)
        if decision.reference not in REFERENCES:
            accepted = ", ".join(REFERENCES)
            raise SpecError("no such", key="supervisor/mode.reference", value=decision.reference, accepted=accepted)

    def supervise(self, decision: Supervision) -> None:
        """Take note of the mode in which the next state is to be answered; see ``check_decision``."""
        self._decision = decision

    def control(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Answer as the law of the mode does; see ``Law.control``."""
        decision = self._decision
        if decision is not None:
            # Whatever else was asked for: the mode decides.
            self._requested = self._first_law if decision.law == CONTROLLER else decision.mode
            if decision.reference != "follow":
                reference = self._hold(decision, state, reference)
            if self._requested != self._active and decision.mode in self._forgetful:
                self._reset_law(self._requested)
        self._failed = False
        try:
            return super().control(state, reference)
        except Exception as error:
            if self._fallback is None or self._active != self._first_law:
                raise
            self._fall_back(self._fallback, error)
        return super().control(state, reference)

    def _fall_back(self, mode: str, error: Exception) -> None:
        """Let the law of that mode answer; the one that failed begins again where it is used again."""
        reason = str(error) if isinstance(error, SpaceRobotError) else f"{type(error).__name__}: {error}"
        self.add_event(LAW_FAILED, {"law": self._active, "reason": reason, "to": mode})
        self._reset_law(self._active)
        self._requested, self._failed = mode, True

    def _reset_law(self, name: str) -> None:
        self.laws[name].reset()
        self._share_wheels()

    def _marks(self) -> tuple[float, ...]:
        return () if self._fallback is None else (float(self._failed),)

    def _hold(self, decision: Supervision, state: RobotState, reference: Reference) -> Reference:
        """What was there at the entry into the mode, at rest."""
        held = self._held
        if held is None or held[:2] != (decision.mode, decision.since):
            still = np.zeros(reference.v.size)
            q = state.q if decision.reference == "here" else reference.q
            held = self._held = decision.mode, decision.since, Reference(state.stamp, q, still, still)
        if held[2].stamp == state.stamp:
            return held[2]
        return Reference(state.stamp, held[2].q, held[2].v, held[2].a)


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


def supervised(experiment: Experiment, robot: Robot, policy: LawPolicy) -> ModeController:
    """The controller of an experiment with a supervision table.

    Args:
        experiment: it has one.
        robot: the NOMINAL robot.
        policy: whose code may be the law of the experiment; those of the table are shipped.

    Raises:
        SpecError: a law, a gain or a value cannot be used.
    """
    table, spec, period = experiment.supervision, experiment.controller, experiment.control_period
    assert table is not None
    first = make_law(policy.law(spec.law, spec.law), robot, period, spec.gains, "controller", policy)
    laws = {spec.law: first}
    modes = {mode: said.law for mode, said in table.modes.items() if said.law != CONTROLLER}
    for mode, law in modes.items():
        laws[mode] = make_law(law, robot, period, table.modes[mode].gains, f"{KEY}.modes.{mode}")
    if not modes:
        laws[IDLE] = make_law("none", robot, period)
    forgetful = [mode for mode, said in table.modes.items() if said.forget]
    return ModeController(
        robot, period, laws, modes=modes, handover=table.handover, forgetful=forgetful, fallback=table.fallback
    )


def check_supervision(experiment: Experiment) -> None:
    """Refuse a table that contradicts itself, or the experiment.

    Raises:
        SpecError: the message names the key.
    """
    table = experiment.supervision
    if table is None:
        return
    table.check(KEY)
    summary = table.housekeeping
    if summary is not None and to_nanoseconds(summary.period, f"{KEY}.housekeeping.period") % experiment.period:
        accepted = f"a multiple of control_period, {experiment.control_period:g} s"
        raise SpecError("no tick", key=f"{KEY}.housekeeping.period", value=summary.period, accepted=accepted)
    end = experiment.steps * experiment.control_period
    for index, step in enumerate(table.schedule):
        if step.at > end:
            raise SpecError(
                "after the end", key=f"{KEY}.schedule.{index}.at", value=step.at, accepted=f"up to {end:g} s"
            )
    if experiment.controller.standby:
        accepted = "laws of modes instead of controller.standby"
        raise SpecError("decides which law runs", key=KEY, accepted=accepted)
    for mode, said in table.modes.items():
        key = f"{KEY}.modes.{mode}"
        if said.law not in (CONTROLLER, *BUILT_IN):
            accepted = nearest(said.law, BUILT_IN) or ", ".join((CONTROLLER, *BUILT_IN))
            raise SpecError("no such shipped law", key=f"{key}.law", value=said.law, accepted=accepted)
        if mode == experiment.controller.law:
            raise SpecError("is the law of the experiment", key=key, accepted="another name")
