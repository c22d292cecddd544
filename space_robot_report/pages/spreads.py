"""How the numbers of a campaign spread: every run a point, a box per axis or per point of the grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from space_robot_bringup.judge.metrics import PER_AXIS, PER_RUN
from space_robot_bringup.judge.verdict import PLANT_BOUNDS
from space_robot_msgs_py.escapes import plotly
from space_robot_report.pages.plots import packed
from space_robot_report.palette import PALETTE

# Of more points per box some are drawn, evenly by size and the ends among them: the box stays where it is.
MAX_POINTS = 400
Rows = Sequence[Mapping[str, Any]]


def spread_figures(groups: Mapping[str, Rows]) -> dict[str, dict[str, Any]]:
    """Heading to figure: one for each number an axis has, one for each number a run has.

    Args:
        groups: name of each point of the grid to its rows.
    """
    figures = {}
    for field in PER_AXIS:
        traces = [
            trace
            for index, (name, rows) in enumerate(groups.items())
            if (trace := _per_axis(field, name, rows, PALETTE[index % len(PALETTE)])) is not None
        ]
        if traces:
            figures[f"{field} by axis"] = _figure(traces, legend=len(groups) > 1)
    for field in [name for name in PER_RUN if name not in PLANT_BOUNDS]:
        columns = {name: _thinned(*_column(rows, field)) for name, rows in groups.items()}
        if any(values.size and np.ptp(values) > 0.0 for values, _ in columns.values()):
            traces = [
                _box(values, [name] * values.size, indices, name, PALETTE[index % len(PALETTE)])
                for index, (name, (values, indices)) in enumerate(columns.items())
            ]
            figures[field] = _figure(traces, legend=False)
    return figures


def _per_axis(field: str, name: str, rows: Rows, color: str) -> dict[str, Any] | None:
    """One box per axis; None where no run has such a number."""
    axes = dict.fromkeys(key.removesuffix(f".{field}") for row in rows for key in row if key.endswith(f".{field}"))
    values, places, indices = [], list[str](), list[int]()
    for axis in axes:
        found, cases = _thinned(*_column(rows, f"{axis}.{field}"))
        values.append(found)
        places += [axis] * found.size
        indices += cases
    return _box(np.concatenate(values), places, indices, name, color) if places else None


def _column(rows: Rows, name: str) -> tuple[Any, list[int]]:
    """The numbers that are there, of runs that completed, and the indices of their cases."""
    there = [row for row in rows if row["completed"] and row.get(name) is not None]
    return np.array([row[name] for row in there], dtype=float), [row["index"] for row in there]


def _thinned(values: Any, indices: list[int]) -> tuple[Any, list[int]]:
    """At most MAX_POINTS of the numbers, evenly by size, with their cases."""
    if values.size <= MAX_POINTS:
        return values, indices
    order = np.argsort(values, kind="stable")
    kept = np.sort(order[np.linspace(0, values.size - 1, MAX_POINTS).round().astype(int)])
    return values[kept], [indices[place] for place in kept]


def _box(values: Any, places: list[str], indices: list[int], name: str, color: str) -> dict[str, Any]:
    return {
        "type": "box",
        "name": plotly(name),
        "x": [plotly(place) for place in places],
        "y": packed(values, "f8"),
        "text": [f"case {index}" for index in indices],
        "boxpoints": "all",
        "jitter": 0.5,
        "pointpos": 0,
        "marker": {"color": color, "size": 4, "opacity": 0.6},
        "line": {"width": 1},
    }


def _figure(traces: list[dict[str, Any]], *, legend: bool) -> dict[str, Any]:
    layout = {"boxmode": "group", "hovermode": "closest", "showlegend": legend, "xaxis": {"title": {"text": ""}}}
    return {"data": traces, "layout": layout}
