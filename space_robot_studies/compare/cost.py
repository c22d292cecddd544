"""What a control cycle of each law costs: its answers to the states of one of its own runs, timed one by one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.modes import headless
from space_robot_msgs_py.log.writer import MemorySink
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.compare.comparison import law_key
from space_robot_studies.engine.tasks import Lost, Stop, Task, Workers
from space_robot_studies.reproduce.timing import time_updates

# Of the run, and of the timed updates.
STEPS, REPEATS = 100, 500


def costs_of(campaign: Campaign, name: str, pool: Workers, stop: Stop = lambda: None) -> dict[str, float | None]:
    """Law to the median wall time of one update [us], at the first point of the grid it stands at.

    Args:
        campaign: resolved.
        name: of it.
        pool: one worker at a time is used: neighbours would share the cores and the caches.
        stop: asked often; a reason ends it early.

    Raises:
        SpecError: see ``law_key``.
    """
    key, found = law_key(campaign, name), dict[str, float | None]()
    for at in range(campaign.points):
        law = str(campaign.point(at).labels[key])
        if law not in found:
            task = Task(law, cost, (make_case(campaign, at).data,))
            for _, outcome in pool.run([task], stop):
                found[law] = None if isinstance(outcome, Lost) else outcome
    return found


def cost(data: Mapping[str, Any]) -> float | None:
    """Median wall time of one update [us] of the law of an experiment; None if it ends its run at once."""
    composition, sink = compose(experiment_from(data, "cost")), MemorySink()
    plant, controller, reference = composition.plant(), composition.controller(), composition.reference()
    steps = min(STEPS, composition.experiment.steps)
    headless.run(plant, controller, reference, steps=steps, sink=sink, supervisor=composition.supervisor())
    ticks = [(tick.sample.state, tick.reference) for tick in sink.ticks]
    times = time_updates(composition.controller(), ticks, REPEATS)
    return None if times is None else times.median
