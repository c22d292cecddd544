"""What the chosen figures need of each run: quantities, curves, whether its bag stays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from pathlib import Path

from space_robot_studies.engine.journal import bag_path
from space_robot_studies.reproduce.manifest import MAX_KEPT, Figure
from space_robot_studies.reproduce.plan import Plan
from space_robot_studies.reproduce.planner import DistinctRun
from space_robot_studies.reproduce.quantities import Quantity, Wanted
from space_robot_studies.reproduce.run import Job, Keep


def job_of(plan: Plan, figures: Sequence[str], run: DistinctRun, directory: Path) -> Job:
    """The job that gives all that these figures need of a run.

    Args:
        plan: of the paper.
        figures: that are chosen.
        run: one of theirs.
        directory: of the reproduction.
    """
    quantities: dict[Quantity, None] = {}
    curves: dict[str, None] = {}
    keeps: set[Keep] = set()
    for name in figures:
        figure = plan.manifest.figures[name]
        runs = plan.shown(name)
        quantities |= {one.quantity: None for one in _measured(plan, name, run) if one.signal}
        mine = {planned.group for planned in runs if planned.distinct is run}
        if not mine:
            # Of a run that only readings need nothing is drawn, and its command gives its bag.
            continue
        for panel in figure.panels:
            if mine & set(panel.of or mine):
                curves |= dict.fromkeys(panel.signals)
        quantities |= {number.quantity: None for number in _numbers(figure, mine) if number.signal}
        timed = figure.timing is not None and mine & set(figure.timing.of)
        keeps.add("all" if timed else figure.keep or ("all" if len(runs) <= MAX_KEPT else "failed"))
    keep: Keep = "all" if "all" in keeps else "failed" if "failed" in keeps else "none"
    place = bag_path(directory, run.name).resolve()
    return Job(run.argument, run.overrides, place, tuple(quantities), tuple(curves), keep)


def _numbers(figure: Figure, mine: Set[str]) -> Iterator[Wanted]:
    """Every number of a run of these groups that charts and tables of a figure need."""
    for chart in (*figure.charts, *figure.grids):
        if mine & set(chart.of or mine):
            yield chart.measure
    for table in figure.tables:
        if mine & set(table.of or mine):
            yield from table.columns.values()


def _measured(plan: Plan, figure: str, run: DistinctRun) -> Iterator[Wanted]:
    """Every number of a run that the claims of a figure need, in any of their readings."""
    for claim, readings in zip(plan.manifest.figures[figure].claims, plan.read[figure], strict=True):
        for reading in readings:
            mine = {planned.group for planned in reading.runs if planned.distinct is run}
            for measure in claim.measures.values() if mine else ():
                if mine & {*measure.groups, measure.over}:
                    yield measure
                if measure.only_if is not None and mine & set(measure.only_if.groups):
                    yield measure.only_if
