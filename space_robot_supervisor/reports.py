"""Events of a supervisor: made only where something happened."""

from __future__ import annotations

from collections.abc import Iterable

from space_robot_msgs_py.events import ERROR, OK, WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Acknowledgement
from space_robot_supervisor.monitors import Edge, Monitor
from space_robot_supervisor.rows import RESERVED, Severity

LEVELS: dict[Severity, int] = {"info": OK, "low": WARN, "medium": WARN, "high": ERROR}
# Names of the events that are no monitor's.
MODE, COMMAND, SEQUENCE = RESERVED
# Who gives a command, where no plan does.
GROUND = "ground"


def edge(stamp: int, monitor: Monitor, how: Edge) -> DiagnosticEvent:
    """A monitor that fires or clears."""
    spec = monitor.spec
    bounds = [
        (name, repr(bound)) for name, bound in (("above", spec.above), ("below", spec.below)) if bound is not None
    ]
    values = (("value", spec.value), ("is", repr(monitor.seen)), *bounds, ("severity", spec.severity))
    level = LEVELS[spec.severity] if how == "fires" else OK
    return DiagnosticEvent(stamp, level, spec.name, how, "", values)


def mode(stamp: int, before: str, after: str, cause: str, severity: Severity) -> DiagnosticEvent:
    """A change of mode."""
    values = (("from", before), ("to", after), ("cause", cause))
    return DiagnosticEvent(stamp, LEVELS[severity], MODE, f"{before} -> {after}", "", values)


def command(stamp: int, name: str, said: Acknowledgement, by: str) -> DiagnosticEvent:
    """A command of the ground, the schedule or a sequence, accepted or refused."""
    values = (("command", name), ("by", by), ("reason", said.reason))
    level, how = (OK, "accepted") if said.accepted else (WARN, "refused")
    return DiagnosticEvent(stamp, level, COMMAND, how, "", values)


def orders_in(events: Iterable[DiagnosticEvent]) -> list[str]:
    """The commands of the ground among events, in order, accepted or refused."""
    found = [dict(event.values) for event in events if event.name == COMMAND]
    return [values.get("command", "") for values in found if values.get("by") == GROUND]


def sequence(stamp: int, name: str, how: str, cause: str) -> DiagnosticEvent:
    """A sequence that starts, ends or is aborted."""
    values = (("sequence", name), *((("cause", cause),) if cause else ()))
    return DiagnosticEvent(stamp, WARN if how == "aborted" else OK, SEQUENCE, how, "", values)
