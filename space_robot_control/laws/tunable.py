"""Gains that change in flight, told as events so that a log says it and a replay can do it again."""

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
        self._untold: list[tuple[str, Mapping[str, Any]]] = []

    def parameters(self) -> Iterator[ParameterRow]:
        """The gains in force, as ``gains.<dotted name>``; those marked dynamic are what ``tune`` takes."""
        return parameter_rows(self.gains, GAINS)

    def tune(self, changes: Mapping[str, Any]) -> None:
        """Change gains in flight, from the next update on, whose output has the event; all of them or none.

        Args:
            changes: ``gains.<dotted name>`` of dynamic gains (``Field(..., json_schema_extra=DYNAMIC)``) to value.

        Raises:
            SpecError: a name or value is not accepted, or the law cannot fly with it.
        """
        for name in changes:
            if not name.startswith(GAINS):
                accepted = f"{GAINS}<name>"
                raise SpecError("there is no such number to change", key=f"controller.{name}", accepted=accepted)
        names = [name.removeprefix(GAINS) for name in changes]
        gains = changed(self.gains, dict(zip(names, changes.values(), strict=True)), f"controller.{GAINS}")
        self.retune(gains)
        self.gains = gains
        self.tell_tuned(changes)

    def retune(self, gains: Any) -> None:
        """Get ready to go on with other gains, as they are in ``gains``; by default nothing is to be done.

        Laws that keep numbers made of dynamic gains override this, and refuse before they change anything.
        """

    def tell(self, kind: str, content: Mapping[str, Any]) -> None:
        """Put an event into the next output, see ``ControllerEvent``."""
        self._untold.append((kind, content))

    def tell_tuned(self, changes: Mapping[str, Any]) -> None:
        """Put what was tuned into the next output."""
        self._tuned |= changes
        self.tell("parameters", {"values": dict(changes)})

    def tell_anew(self) -> None:
        """Forget what was not told yet; a run that starts with other gains than its experiment says tells so first."""
        self._untold = [("parameters", {"values": dict(self._tuned)})] if self._tuned else []

    def told(self, stamp: int) -> tuple[ControllerEvent, ...]:
        """What was to be told, under the stamp [ns] of the output it goes with."""
        if not self._untold:
            return ()
        events = tuple(ControllerEvent(stamp, kind, content) for kind, content in self._untold)
        self._untold = []
        return events
