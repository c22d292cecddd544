"""Repeats what a log says happened to a controller or a supervisor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from space_robot_bringup.compose.supervision import ModeController
from space_robot_control.laws.base import Law
from space_robot_control.laws.recorded_events import apply_event
from space_robot_msgs_py.events import ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import (
    Acknowledgement,
    ControlOutput,
    Reference,
    RobotState,
    Supervision,
    SupervisorUnit,
)


class RepeatedOrders:
    """A supervisor which gets the commands that the ground gave, at the stamps at which a log has them.

    Args:
        supervisor: a fresh one.
        orders: by stamp [ns].
    """

    def __init__(self, supervisor: SupervisorUnit, orders: Mapping[int, Sequence[str]]) -> None:
        self._supervisor, self._orders = supervisor, orders

    def reset(self) -> None:
        """Forget the past."""
        self._supervisor.reset()

    def order(self, command: str) -> Acknowledgement:
        """Take one more command."""
        return self._supervisor.order(command)

    def update(
        self,
        state: RobotState,
        reference: Reference,
        answer: ControlOutput | None = None,
        events: Sequence[DiagnosticEvent] = (),
    ) -> Supervision:
        """Look at one state, ordered as the log says."""
        for command in self._orders.get(state.stamp, ()):
            self._supervisor.order(command)
        return self._supervisor.update(state, reference, answer, events)


class Repeated:
    """A controller to which everything happens at the stamps at which a log says it happened.

    Args:
        law: a fresh one.
        events: by stamp [ns].
    """

    def __init__(self, law: Law, events: Mapping[int, Sequence[ControllerEvent]]) -> None:
        self._law, self._events = law, events

    def reset(self) -> None:
        """Forget the past."""
        self._law.reset()

    def check_decision(self, decision: Supervision) -> None:
        """Pass on the question."""
        if isinstance(self._law, ModeController):
            self._law.check_decision(decision)

    def supervise(self, decision: Supervision) -> None:
        """Pass on the mode of the next state."""
        if isinstance(self._law, ModeController):
            self._law.supervise(decision)

    def update(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Answer one state, changed as the events of its stamp say."""
        for event in self._events.get(state.stamp, ()):
            apply_event(self._law, event)
        return self._law.update(state, reference)
