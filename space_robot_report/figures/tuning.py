"""A search as a picture: how it converged, error against effort, and what each gain does around the best."""

from __future__ import annotations

import io
from typing import Any

from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from space_robot_report.figures.chart import plain
from space_robot_report.figures.paper import LOOK
from space_robot_report.figures.pictures import own_settings, plt
from space_robot_report.palette import PALETTE
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.tune.outcome import FRONT, StandResult
from space_robot_studies.tune.ranking import Evaluation, pareto

SIZE = (10.5, 2.9)
SHIPPED, BEST, TRIED = PALETTE[1], PALETTE[2], PALETTE[0]


def picture_of(stand: StandResult) -> bytes:
    """A PNG file."""
    with own_settings(LOOK):
        picture, axes = plt.subplots(1, 3, figsize=SIZE, layout="constrained")
        try:
            _convergence(axes[0], stand)
            _front(axes[1], stand)
            _sensitivity(axes[2], stand)
            stream = io.BytesIO()
            picture.savefig(stream, dpi=90, format="png")
        finally:
            plt.close(picture)
    return stream.getvalue()


def _spread_ticks(axis: Any) -> None:
    """Ticks of a logarithmic scale that do not run into each other over less than a decade."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=8))
    axis.set_major_formatter(FormatStrFormatter("%g"))
    axis.set_minor_formatter(NullFormatter())


def _convergence(axis: Any, stand: StandResult) -> None:
    """Every feasible evaluation, and the best so far."""
    there = [one for one in stand.evaluations if one.feasible]
    axis.plot([one.number for one in there], [one.objective for one in there], ".", color=TRIED, alpha=0.4)
    best = [(k, value) for k, value in enumerate(stand.convergence()) if value is not None]
    axis.step([k for k, _ in best], [value for _, value in best], where="post", color=BEST)
    axis.set_yscale("log")
    _spread_ticks(axis.yaxis)
    axis.set_xlabel("evaluation")
    axis.set_ylabel("objective")


def _front(axis: Any, stand: StandResult) -> None:
    """Feasible evaluations, those no other one beats, shipped and best."""
    groups: list[tuple[list[Evaluation], str, str]] = [
        ([one for one in stand.evaluations if one.feasible], ".", TRIED),
        ([stand.evaluations[0]], "s", SHIPPED),
        ([stand.best], "o", BEST),
    ]
    for evaluations, mark, color in groups:
        pairs = [(one.mean(FRONT[0]), one.mean(FRONT[1])) for one in evaluations]
        there = [pair for pair in pairs if None not in pair]
        axis.plot([a for a, _ in there], [b for _, b in there], mark, color=color)
    front = pareto(stand.evaluations, *FRONT)
    axis.plot([one.mean(FRONT[0]) for one in front], [one.mean(FRONT[1]) for one in front], color=TRIED, linewidth=0.8)
    axis.set_xscale("log")
    _spread_ticks(axis.xaxis)
    axis.set_xlabel(METRICS[FRONT[0]], fontsize="small")
    axis.set_ylabel(METRICS[FRONT[1]], fontsize="small")
    axis.legend(axis.get_lines()[1:3], ["shipped", "tuned"])


def _sensitivity(axis: Any, stand: StandResult) -> None:
    """The objective a tenth of the range below and above the best value, over the best one."""
    found, best = stand.sensitivity(), stand.best.objective
    if not found or not best:
        axis.text(0.5, 0.5, "the shipped gains are the best", ha="center", va="center")
        axis.set_axis_off()
        return
    for place, ends in enumerate(found.values()):
        for side, value in zip((-0.15, 0.15), ends, strict=True):
            if value is not None:
                axis.barh(place + side, value / best, height=0.28, color=PALETTE[5 if side < 0 else 0])
    axis.axvline(1.0, color="black", linewidth=0.8)
    axis.set_yticks(range(len(found)), [plain(name) for name in found])
    axis.invert_yaxis()
    axis.set_xlabel("objective 10 % of the range below (light),\nabove (dark), over the best [-]", fontsize="small")
