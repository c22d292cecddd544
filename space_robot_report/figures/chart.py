"""Numbers of runs as dots, over a key of the experiment or side by side, with what they reduce to."""

from __future__ import annotations

from typing import Any

from space_robot_msgs_py.escapes import mathtext
from space_robot_report.figures.curves import shown
from space_robot_report.palette import PALETTE
from space_robot_studies.reproduce.manifest import Chart
from space_robot_studies.reproduce.measures import FinishedRun, reduce
from space_robot_studies.reproduce.reproduction import FigureResult

HALF_BAR, GOLDEN = 0.3, 0.618033988749895


def draw_chart(axis: Any, chart: Chart, result: FigureResult) -> None:
    """Draw every run that has the number as a dot and say how many have none."""
    runs = shown(chart, result)
    without = 0
    for column, group in enumerate(dict.fromkeys(run.group for run, _ in runs)):
        members = [pair for pair in runs if pair[0].group == group]
        points: dict[float, list[FinishedRun]] = {}
        for pair in members:
            points.setdefault(float(pair[0].values[chart.x]) if chart.x else float(column), []).append(pair)
        without += _draw_group(axis, chart, result, dict(sorted(points.items())))
    if without:
        text = f"{without} of {len(runs)} runs without this number"
        axis.text(0.99, 0.97, text, transform=axis.transAxes, ha="right", va="top", fontsize="small", color="#a00")
    if chart.x:
        axis.set_xscale(chart.x_scale)
        axis.set_xlabel(plain(chart.x_label or chart.x))
        for text, x in chart.marks.items():
            axis.axvline(x, color="#808080", linestyle="dotted", linewidth=1.0)
            axis.annotate(plain(text), (x, 0.02), xycoords=("data", "axes fraction"), rotation=90, fontsize="x-small")
    else:
        groups = list(dict.fromkeys(run.group for run, _ in runs))
        axis.set_xticks(range(len(groups)), [plain(chart.legend.get(group, group)) for group in groups])
        axis.set_xlim(-0.5, len(groups) - 0.5)


plain = mathtext


def _draw_group(axis: Any, chart: Chart, result: FigureResult, points: dict[float, list[FinishedRun]]) -> int:
    """Draw a group and return how many of its runs lack the number."""
    members = [pair for pairs in points.values() for pair in pairs]
    color = _color(chart, result, members[0][0].group)
    without, line = 0, {}
    for x, pairs in points.items():
        numbers = [pair[1].number(chart.measure.quantity, result.figure.diverged) for pair in pairs]
        without += numbers.count(None)
        there = [value for value in numbers if value is not None]
        places = [x] * len(there) if chart.x else [x + _aside(index) for index in range(len(there))]
        axis.plot(places, there, "o", color=color, markersize=4, alpha=0.5, label="_")
        value = reduce(chart.measure, pairs, result.figure.diverged).value
        if value is not None and (chart.measure.reduce or len(pairs) == 1):
            line[x] = value
    if chart.x:
        text = chart.legend.get(members[0][0].group, members[0][0].group)
        axis.plot(list(line), list(line.values()), color=color, label=plain(text) or "_")
    else:
        for x, value in line.items():
            axis.hlines(value, x - HALF_BAR, x + HALF_BAR, color=color, linewidth=2.0)
    return without


def _aside(index: int) -> float:
    """Where the dots of a column stand: spread evenly, the first in the middle, the same every time."""
    return HALF_BAR * (2.0 * ((0.5 + index * GOLDEN) % 1.0) - 1.0)


def _color(chart: Chart, result: FigureResult, group: str) -> str:
    """One color per group: the abscissa tells the runs of a group apart."""
    style = chart.style.get(group)
    index = list(result.figure.runs).index(group)
    return style.color if style and style.color else PALETTE[index % len(PALETTE)]
