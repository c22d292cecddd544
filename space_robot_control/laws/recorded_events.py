"""Applies a recorded parameter change, switch or reset to another law: a fresh one, or that of a second controller."""

from __future__ import annotations

from space_robot_control.laws.base import Law
from space_robot_control.laws.switching import Switching
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import LAW_FAILED, RECORDED, ControllerEvent


def apply_event(law: Law, event: ControllerEvent) -> None:
    """Change a law as an event says it was changed; the law tells of it in its next output.

    Args:
        law: before it answers the state with the event's stamp.
        event: of a log, so its content may be anything.

    Raises:
        SpecError: this law cannot be changed so.
    """
    content = event.content
    if event.kind in RECORDED or event.kind == LAW_FAILED:
        # A law that failed fails again by itself.
        return
    if event.kind == "parameters" and isinstance(content.get("values"), dict):
        law.tune(content["values"])
    elif event.kind == "switch" and isinstance(law, Switching):
        # One that was scheduled is done by the law itself; saying it again changes nothing.
        law.switch_to(str(content.get("to")))
    elif event.kind == "reset":
        law.reset_in_run()
    else:
        raise SpecError("does not fit this law", key="controller/events", value=event.line[:80])
