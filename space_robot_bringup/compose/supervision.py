"""A supervised controller: the law of the experiment and those of the modes, behind a supervisor that decides."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import LawPolicy
from space_robot_control.laws.registry import BUILT_IN, make_law
from space_robot_control.laws.switching import ACTIVE, Switching
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.actuation import command_limit
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import ControlOutput, Reference, RobotState
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.table import CONTROLLER, SupervisionTable
from space_robot_supervisor.values import Snapshot

KEY = "supervision"
# Stands by where no mode has a law of its own: who switches needs two.
IDLE = "none"


class SupervisedController(Switching):
    """Laws that take turns as a supervisor decides, each with the reference of its mode.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        laws: of the experiment first, then of the modes, by the modes' names.
        table: modes and monitors.

    Raises:
        SpecError: a monitor reads what there is not.
    """

    def __init__(
        self, robot: Robot, control_period: float, laws: Mapping[str, Law], *, table: SupervisionTable
    ) -> None:
        labels = [*ERROR_FIELDS, ACTIVE, "handover"]
        for name, law in laws.items():
            labels += [f"{name}.{label}" for label in law.telemetry_fields if label not in ERROR_FIELDS]
        self._supervisor = Supervisor(table, robot, labels, command_limit(robot), KEY)
        self._first_law = next(iter(laws))
        self._output: ControlOutput | None = None
        super().__init__(robot, control_period, laws, handover=table.handover)

    def reset(self) -> None:
        """Back to the first mode and its law; all laws are reset."""
        super().reset()
        self._supervisor.reset()
        self._output = None

    def control(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Decide on the mode, then answer as its law does; see ``Law.control``."""
        last = self._output
        command, telemetry = (None, None) if last is None else (last.command, last.telemetry)
        known = Snapshot(state, reference, command, telemetry, self.wheels.momentum)
        found = self._supervisor.update(known)
        # Whatever else was asked for: the mode decides.
        self.switch_to(self._first_law if self._supervisor.active.law == CONTROLLER else found.mode)
        output = super().control(state, found.reference)
        self._output = replace(output, supervision=found.events)
        return self._output


def supervised(experiment: Experiment, robot: Robot, policy: LawPolicy) -> SupervisedController:
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
    for mode, said in table.modes.items():
        if said.law != CONTROLLER:
            laws[mode] = make_law(said.law, robot, period, said.gains, f"{KEY}.modes.{mode}")
    if len(laws) == 1:
        laws[IDLE] = make_law(IDLE, robot, period)
    return SupervisedController(robot, period, laws, table=table)


def check_supervision(experiment: Experiment) -> None:
    """Refuse a table that contradicts itself, or the experiment.

    Raises:
        SpecError: the message names the key.
    """
    table = experiment.supervision
    if table is None:
        return
    table.check(KEY)
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
