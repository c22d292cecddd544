"""How results look: tables for people, one dictionary for programs."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from space_robot_bringup.experiment import Experiment
from space_robot_bringup.metrics import RunMetrics
from space_robot_bringup.run import RunResult


def as_dict(experiment: Experiment, mode: str, result: RunResult) -> dict[str, Any]:
    """The verdict as plain data; absent numbers are None, none is NaN."""
    metrics = result.metrics
    simulated = metrics.simulated_time if metrics else 0.0
    return {
        "title": experiment.title,
        "mode": mode,
        "directory": str(result.directory),
        "end_reason": result.end_reason,
        "passed": result.passed,
        "wall_time": result.wall_time,
        "real_time_factor": simulated / result.wall_time,
        "ticks": metrics.ticks if metrics else 0,
        "simulated_time": simulated,
        "metrics": metrics.flat() if metrics else {},
        "checks": [
            {"name": c.name, "measured": c.measured, "wanted": c.wanted, "passed": c.passed} for c in result.checks
        ],
    }


def verdict(console: Console, experiment: Experiment, mode: str, result: RunResult) -> None:
    """Print the axes, the totals, the checks and where the bag is."""
    if result.metrics is not None:
        console.print(_axes(experiment, result.metrics))
        console.print(_totals(mode, result, result.metrics))
    for check in result.checks:
        if not check.passed:
            measured = "none" if check.measured is None else f"{check.measured:g}"
            console.print(f"failed: {check.name} is {measured}, wanted {check.wanted}", style="red", markup=False)
    console.print(f"log: {result.directory}", markup=False, soft_wrap=True)
    word, style = ("PASS", "bold green") if result.passed else ("FAIL", "bold red")
    console.print(f"{word} ({result.end_reason})", style=style, markup=False, soft_wrap=True)


def _axes(experiment: Experiment, metrics: RunMetrics) -> Table:
    table = Table(title=experiment.title or None, title_justify="left")
    table.add_column("axis")
    for heading in ("travel", "final error", "max error", "rms error", "settling 2 % [s]", "overshoot [%]"):
        table.add_column(heading, justify="right")
    for axis in metrics.axes:
        lengths = (axis.travel, axis.final_error, axis.max_error, axis.rms_error)
        table.add_row(
            f"{axis.name} [{axis.unit}]".replace("[", r"\["),
            *(f"{value:.4g}" for value in lengths),
            "-" if axis.settling_time is None else f"{axis.settling_time:g}",
            "-" if axis.overshoot is None else f"{axis.overshoot:.2f}",
        )
    return table


def _totals(mode: str, result: RunResult, metrics: RunMetrics) -> Table:
    table = Table(show_header=False, box=None)
    rows = {
        "saturation share": f"{100 * metrics.saturation_share:.1f} % of periods",
        "momentum residual": f"{metrics.momentum_residual:.1e}",
        "energy residual": f"{metrics.energy_residual:.1e}",
        "torque integral": f"{metrics.effort_integral:.4g} N m s",
        "joint limits": "kept" if metrics.joint_limit == 0.0 else f"exceeded by {metrics.joint_limit:.3g} rad",
        "wall time": f"{result.wall_time:.2f} s for {metrics.simulated_time:g} s ({mode})",
        "x real time": f"{metrics.simulated_time / result.wall_time:.0f}",
    }
    for name, value in rows.items():
        table.add_row(name, value)
    return table


def robot(console: Console, report: Any) -> None:
    """Print a robot report as name and value lines."""
    table = Table(show_header=False, box=None)
    for name, value in report.to_dict().items():
        if not isinstance(value, dict | list):
            table.add_row(name, f"{value:g}" if isinstance(value, float) else str(value))
    console.print(table)
