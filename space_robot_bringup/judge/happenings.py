"""What the events of a run are called where an experiment speaks of them."""

from __future__ import annotations

from collections.abc import Iterator

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_sim.command_monitor import CLIPPED, MISSING, REFUSED
from space_robot_sim.faults.plan import BEGINS, ENDS, FaultPlan
from space_robot_supervisor.reports import MODE

FIRES, CLEARS = "fires", "clears"


def names_of(event: DiagnosticEvent) -> tuple[str, ...]:
    """Every name of an event: ``NAME MESSAGE``, ``NAME`` alone unless it is the end of something, ``mode MODE``."""
    mode = entered(event)
    if mode is not None:
        return (f"{MODE} {mode}",)
    whole = f"{event.name} {event.message}"
    return (whole,) if event.message in (ENDS, CLEARS) else (event.name, whole)


def entered(event: DiagnosticEvent) -> str | None:
    """The mode that an event is the beginning of."""
    return dict(event.values).get("to") if event.name == MODE else None


def known_names(experiment: Experiment, plan: FaultPlan | None) -> Iterator[str]:
    """The names of all events that a run can have."""
    for planned in plan.planned if plan is not None else ():
        yield planned.label
        yield from (f"{planned.label} {message}" for message in (BEGINS, ENDS))
    if (table := experiment.supervision) is not None:
        for monitor in table.monitors:
            yield monitor.name
            yield from (f"{monitor.name} {message}" for message in (FIRES, CLEARS))
        yield from (f"{MODE} {mode}" for mode in table.modes)
    if experiment.plant.monitor is not None:
        yield from (MISSING, REFUSED, CLIPPED)
