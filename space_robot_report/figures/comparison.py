"""A comparison as a picture: over the control period, a column per condition, a line per law."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from space_robot_msgs_py.errors import LogError
from space_robot_report.figures.chart import plain
from space_robot_report.figures.paper import LOOK
from space_robot_report.figures.pictures import own_settings, plt
from space_robot_report.palette import PALETTE
from space_robot_studies.compare.comparison import METRICS, Cell, Comparison
from space_robot_studies.compare.tables import words

DRAWN = ("settling_time", "joint_error", "torque_integral")
WIDTH, HEIGHT = 2.8, 2.3


def draw_comparison(comparison: Comparison, path: Path) -> None:
    """Draw a PNG file; where not all runs settled the mark is hollow, where none completed there is none.

    Raises:
        LogError: it cannot be written.
    """
    conditions = comparison.conditions
    with own_settings(LOOK):
        size = (WIDTH * len(conditions) + 1.2, HEIGHT * len(DRAWN))
        rows = len(DRAWN), len(conditions)
        picture, axes = plt.subplots(
            *rows, figsize=size, layout="constrained", squeeze=False, sharex=True, sharey="row"
        )
        try:
            for row, metric in zip(axes, DRAWN, strict=True):
                row[0].set_ylabel(METRICS[metric].replace(" [", "\n["), fontsize="small")
                for axis, condition in zip(row, conditions, strict=True):
                    for place, law in enumerate(comparison.laws):
                        cells = [comparison.cell(law, period, condition) for period in comparison.periods]
                        _line(axis, cells, metric, PALETTE[place % len(PALETTE)])
                    _dress(axis, comparison.periods, log=metric != "settling_time")
            for axis, condition in zip(axes[0], conditions, strict=True):
                axis.set_title(plain(words(condition)), fontsize="small")
            for axis in axes[-1]:
                axis.set_xlabel("control period [s]", fontsize="small")
            lines = axes[0, 0].get_lines()[: 2 * len(comparison.laws) : 2]
            picture.legend(lines, [plain(law) for law in comparison.laws], loc="outside right upper")
            picture.savefig(path, dpi=80, format="png")
        except OSError as error:
            raise LogError(f"the picture cannot be written: {error.strerror or error}", key=str(path)) from None
        finally:
            plt.close(picture)


def _line(axis: Any, cells: list[Cell], metric: str, color: str) -> None:
    """The medians, hollow where some run did not settle."""
    there = [cell for cell in cells if cell.medians[metric] is not None]
    axis.plot([c.period for c in there], [c.medians[metric] for c in there], "-o", color=color, markersize=4)
    failed = [cell for cell in there if cell.settled < cell.runs]
    values = [cell.medians[metric] for cell in failed]
    axis.plot([c.period for c in failed], values, "o", color=color, markerfacecolor="white", markersize=4)


def _dress(axis: Any, periods: list[float], *, log: bool) -> None:
    axis.set_xscale("log")
    axis.set_xticks(periods, [f"{period:g}" for period in periods])
    axis.minorticks_off()
    if log:
        axis.set_yscale("log")
