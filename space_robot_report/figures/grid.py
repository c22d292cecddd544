"""A number over two keys of the experiment as colored cells, with what a formula says of them drawn over it."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_report.figures.chart import plain
from space_robot_report.figures.curves import shown
from space_robot_report.palette import PALETTE
from space_robot_studies.reproduce.expression import Formula
from space_robot_studies.reproduce.manifest import Grid
from space_robot_studies.reproduce.measures import FinishedRun, reduce
from space_robot_studies.reproduce.reproduction import FigureResult

NONE = "#e3d5d5"
LINES = ("solid", "dashed", "dashdot", "dotted")
FINE = 200


def draw_grid(axis: Any, grid: Grid, result: FigureResult) -> None:
    """Draw one cell per point, grey where no run has the number, and the formulas as lines."""
    points: dict[tuple[float, float], list[FinishedRun]] = {}
    for run in shown(grid, result):
        values = run[0].values
        points.setdefault((float(values[grid.x]), float(values[grid.y])), []).append(run)
    xs, ys = (np.unique([point[i] for point in points]) for i in (0, 1))
    cells = np.full((ys.size, xs.size), np.nan)
    for (x, y), runs in points.items():
        value = reduce(grid.measure, runs, result.figure.diverged).value
        if value is not None:
            cells[np.searchsorted(ys, y), np.searchsorted(xs, x)] = value
    edges_x, edges_y = _edges(xs, grid.x_scale == "log"), _edges(ys, grid.y_scale == "log")
    axis.set_facecolor(NONE)
    axis.grid(visible=False)
    mesh = axis.pcolormesh(
        edges_x, edges_y, np.ma.masked_invalid(cells), cmap="viridis_r", vmin=_limit(grid, 0), vmax=_limit(grid, 1)
    )
    bar = axis.figure.colorbar(mesh, ax=axis, pad=0.02)
    bar.set_label(plain(grid.label or str(grid.measure.quantity)) + ", grey: none")
    _draw_lines(axis, grid, edges_x)
    axis.set_xscale(grid.x_scale)
    axis.set_yscale(grid.y_scale)
    axis.set_xlim(edges_x[0], edges_x[-1])
    axis.set_ylim(edges_y[0], edges_y[-1])
    axis.set_xlabel(plain(grid.x_label or grid.x))
    axis.set_ylabel(plain(grid.y_label or grid.y))
    axis.set_title(plain(", ".join(grid.of or result.figure.runs)), loc="left", fontsize="medium")


def _draw_lines(axis: Any, grid: Grid, edges: Vector) -> None:
    ends = edges[0], edges[-1]
    places = np.geomspace(*ends, FINE) if grid.x_scale == "log" else np.linspace(*ends, FINE)
    for index, (text, formula) in enumerate(grid.lines.items()):
        rule = Formula(formula, ("x",), f"lines.{text}")
        look = {"color": PALETTE[(1 + index) % len(PALETTE)], "linestyle": LINES[index % len(LINES)]}
        axis.plot(places, [rule.value({"x": float(x)}) for x in places], label=plain(text), linewidth=2.0, **look)
    if grid.lines:
        axis.legend(loc="lower left", frameon=True)


def _edges(values: Vector, logarithmic: bool) -> Vector:
    """Borders half-way between the values, on the scale they are drawn on."""
    x = np.log(values) if logarithmic else values
    half = np.diff(x) / 2.0 if x.size > 1 else np.array([0.5])
    edges: Vector = np.concatenate(([x[0] - half[0]], x[:-1] + half[: x.size - 1], [x[-1] + half[-1]]))
    return np.exp(edges) if logarithmic else edges


def _limit(grid: Grid, which: int) -> float | None:
    return None if grid.limits is None else grid.limits[which]
