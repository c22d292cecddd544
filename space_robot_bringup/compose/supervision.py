"""A supervised controller, whose law and reference follow the mode, and what is refused of a table."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.timebase import to_nanoseconds
from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import LawPolicy
from space_robot_control.laws.registry import BUILT_IN, make_law
from space_robot_control.laws.switching import Switching
from space_robot_control.reallocation import Reallocation
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.events import LAW_FAILED
from space_robot_msgs_py.interfaces import (
    ControlOutput,
    Reference,
    RobotState,
    Supervision,
)
from space_robot_supervisor.rows import CONTROLLER, REFERENCES
from space_robot_supervisor.table import SupervisionTable
from space_robot_supervisor.values import WHEELS

KEY = "supervision"
# Stands by where no mode has a law of its own: who switches needs two.
IDLE = "idle"


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
        around: by mode what is commanded around wheels that failed.
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
        around: Mapping[str, Reallocation] | None = None,
    ) -> None:
        self._around = dict(around or {})
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
        output = self._answer_of_mode(state, reference)
        around = self._around.get(self._decision.mode) if self._around and self._decision is not None else None
        # The laws know of the torque that the base gets, and of no other.
        return output if around is None else replace(output, command=around.command(output.command))

    def _answer_of_mode(self, state: RobotState, reference: Reference) -> ControlOutput:
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
    around = {
        mode: Reallocation(robot, said.wheels_off, f"{KEY}.modes.{mode}.wheels_off")
        for mode, said in table.modes.items()
        if said.wheels_off
    }
    options: dict[str, Any] = {"forgetful": forgetful, "fallback": table.fallback, "around": around}
    return ModeController(robot, period, laws, modes=modes, handover=table.handover, **options)


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
    _check_wheels(experiment, table)
    for mode, said in table.modes.items():
        key = f"{KEY}.modes.{mode}"
        if said.law not in (CONTROLLER, *BUILT_IN):
            accepted = nearest(said.law, BUILT_IN) or ", ".join((CONTROLLER, *BUILT_IN))
            raise SpecError("no such shipped law", key=f"{key}.law", value=said.law, accepted=accepted)
        if mode == experiment.controller.law:
            raise SpecError("is the law of the experiment", key=key, accepted="another name")


def _check_wheels(experiment: Experiment, table: SupervisionTable) -> None:
    """Refuse to reckon the momentum of wheels from commands that are meant for some of them."""
    off = [mode for mode, said in table.modes.items() if said.wheels_off]
    summed = () if table.housekeeping is None else table.housekeeping.values
    reads = WHEELS in (*(row.value for row in table.monitors), *summed)
    sensors = getattr(experiment.plant, "sensors", None)
    if off and reads and getattr(sensors, "wheel_momentum", None) is None:
        accepted = f"plant.sensors.wheel_momentum, or no {WHEELS} in the table"
        raise SpecError("needs a reading of the wheels", key=f"{KEY}.modes.{off[0]}.wheels_off", accepted=accepted)
