"""Whether what is flexible in the real robot goes together with the rest of an experiment."""

from __future__ import annotations

from space_robot_bringup.compose.plants import Changes, brakes_when_silent
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_description.robot import Robot
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.flexible.modes import mode_frequencies
from space_robot_sim.flexible.parts import FlexibleParts


def modes_of(experiment: Experiment, truth: Robot) -> tuple[str, ...]:
    """What `space-robot check` says of the modes of a flexible robot; nothing of a rigid one."""
    spec = experiment.plant
    if not isinstance(spec, PlantSpec) or spec.flexibility is None:
        return ()
    found = mode_frequencies(FlexibleParts(spec.flexibility, truth).rates)
    return (f"flexible modes at home: {', '.join(f'{one:.3g}' for one in found) or 'none that oscillates'} [Hz]",)


def check_flexibility(experiment: Experiment, truth: Robot, changes: Changes, plan: FaultPlan | None) -> None:
    """Refuse what its bodies and gears cannot be combined with.

    Args:
        experiment: of the run.
        truth: the true robot, as it starts.
        changes: the true robots of the course of the run: of each link that loses mass enough has to remain.
        plan: of the faults; None: nothing goes wrong.

    Raises:
        SpecError: the message names the key.
    """
    spec, table = experiment.plant, experiment.supervision
    if not isinstance(spec, PlantSpec) or spec.flexibility is None:
        return
    # Here: it knows the models of faults, which take their time to be made.
    from space_robot_sim.flexible.composed import check_composed

    parts = FlexibleParts(spec.flexibility, truth)
    braked = brakes_when_silent(spec) or (table is not None and table.brakes)
    check_composed(parts, truth, braked=braked, plan=plan)
    for change in changes:
        parts.model(change.robot)
