"""What the events of a run are called where an experiment speaks of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_sim.command_monitor import CLIPPED, MISSING, REFUSED
from space_robot_sim.faults.plan import BEGINS, ENDS, FaultPlan
from space_robot_supervisor.reports import COMMAND, MODE, SEQUENCE
from space_robot_supervisor.rows import COMMANDS

FIRES, CLEARS = "fires", "clears"
ANSWERS = ("accepted", "refused")
STEPS = ("starts", "ends", "aborted")
# Messages that are the end of something.
LAST = frozenset((ENDS, CLEARS, *STEPS[1:]))


def names_of(event: DiagnosticEvent) -> tuple[str, ...]:
    """Every name of an event: ``NAME MESSAGE``, ``NAME`` alone unless it is the end of something, ``mode MODE``.

    Of commands and sequences NAME is ``command safe``, ``sequence stow``.
    """
    mode = entered(event)
    if mode is not None:
        return (f"{MODE} {mode}",)
    name = f"{event.name} {dict(event.values).get(event.name)}" if event.name in (COMMAND, SEQUENCE) else event.name
    whole = f"{name} {event.message}"
    return (whole,) if event.message in LAST else (name, whole)


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
        yield from _with_messages((f"{COMMAND} {command}" for command in COMMANDS), ANSWERS)
        yield from _with_messages((f"{SEQUENCE} {name}" for name in table.sequences), STEPS)
    if experiment.plant.monitor is not None:
        yield from (MISSING, REFUSED, CLIPPED)


def _with_messages(names: Iterable[str], messages: Iterable[str]) -> Iterator[str]:
    for name in names:
        yield name
        yield from (f"{name} {message}" for message in messages)
