"""Gains that change during a run, with an event for each change: the log has it and a replay repeats it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from space_robot_description.fields import changed, parameter_rows
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.parameters import ParameterRow

GAINS = "gains."


class Tunable:
    """The part of a law that takes other gains between two updates.

    Attributes:
        gains: in force.
    """

    gains: Any

    def __init__(self) -> None:
        self._tuned: dict[str, Any] = {}
        self._pending: list[tuple[str, Mapping[str, Any]]] = []

    def parameters(self) -> Iterator[ParameterRow]:
        """The gains in force, as ``gains.<dotted name>``; those marked dynamic are what ``tune`` takes."""
        return parameter_rows(self.gains, GAINS)

    def tune(self, changes: Mapping[str, Any]) -> None:
        """Change gains during a run, from the next update on, whose output has the event; all of them or none.

        Args:
            changes: ``gains.<dotted name>`` of dynamic gains (``Field(..., json_schema_extra=DYNAMIC)``) to value.

        Raises:
            SpecError: a name or value is not accepted, or the law cannot work with it.
        """
        for name in changes:
            if not name.startswith(GAINS):
                accepted = f"{GAINS}<name>"
                raise SpecError("there is no such number to change", key=f"controller.{name}", accepted=accepted)
        names = [name.removeprefix(GAINS) for name in changes]
        gains = changed(self.gains, dict(zip(names, changes.values(), strict=True)), f"controller.{GAINS}")
        self.retune(gains)
        self.gains = gains
        self.add_parameters_event(changes)

    def retune(self, gains: Any) -> None:
        """Prepare to go on with other gains; by default nothing is to be done.

        Laws that keep numbers made of dynamic gains override this, and refuse before they change anything.
        """

    def add_event(self, kind: str, content: Mapping[str, Any]) -> None:
        """Put an event into the next output, see ``ControllerEvent``."""
        self._pending.append((kind, content))

    def add_parameters_event(self, changes: Mapping[str, Any]) -> None:
        """Put changed gains into the next output, and into the first output of every later run."""
        self._tuned |= changes
        self.add_event("parameters", {"values": dict(changes)})

    def restart_events(self) -> None:
        """Drop pending events; a run whose gains differ from its experiment's begins with an event that has them."""
        self._pending = [("parameters", {"values": dict(self._tuned)})] if self._tuned else []

    def pending_events(self, stamp: int) -> tuple[ControllerEvent, ...]:
        """Take the pending events, under the stamp [ns] of the output they go with."""
        if not self._pending:
            return ()
        events = tuple(ControllerEvent(stamp, kind, content) for kind, content in self._pending)
        self._pending = []
        return events
