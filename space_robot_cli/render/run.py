"""How results look: tables for people, one dictionary for programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.metrics import ROTATIONS, RunMetrics
from space_robot_bringup.judge.remarks import Remark
from space_robot_bringup.modes.run import RunResult
from space_robot_cli.terminal import markup

# Of a verdict, by whether the run passed; None: nothing was expected.
STYLES: Mapping[bool | None, str] = {True: "bold green", False: "bold red", None: "bold yellow"}


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
        "verdict": result.conclusion,
        "remarks": [asdict(remark) for remark in result.remarks],
        "wall_time": result.wall_time,
        "real_time_factor": simulated / result.wall_time if result.wall_time else None,
        "ticks": metrics.ticks if metrics else 0,
        "simulated_time": simulated,
        "metrics": metrics.flat() if metrics else {},
        "checks": [asdict(check) for check in result.checks],
    }


def verdict(console: Console, experiment: Experiment, mode: str, result: RunResult, whole_time: float) -> None:
    """Print the axes, the totals, the checks and where the bag is.

    Args:
        console: to print on.
        experiment: that was run.
        mode: how.
        result: of the run.
        whole_time: of the command until now, set-up and verdict included [s].
    """
    if result.metrics is not None:
        console.print(_axes(experiment, result.metrics))
        console.print(ROTATIONS, style="dim", markup=False, soft_wrap=True)
        console.print(_totals(mode, result, result.metrics, whole_time))
    missed(console, result.checks, result.remarks)
    console.print(f"log: {result.directory}", markup=False, soft_wrap=True)
    ended = "" if result.passed is None else f" ({result.end_reason})"
    console.print(f"{result.conclusion}{ended}", style=STYLES[result.passed], markup=False, soft_wrap=True)


def missed(console: Console, checks: Iterable[Check], remarks: Iterable[Remark]) -> None:
    """Print each check that does not hold or is not judged, and what else happened."""
    for check in checks:
        if not check.passed:
            console.print(check.line, style="red" if check.judged else "yellow", markup=False, soft_wrap=True)
    for remark in remarks:
        console.print(f"remark: {remark.line}", style="yellow", markup=False, soft_wrap=True)


def _axes(experiment: Experiment, metrics: RunMetrics) -> Table:
    table = Table(title=markup(experiment.title) or None, title_justify="left", box=SIMPLE_HEAD)
    table.add_column("axis", no_wrap=True)
    for heading in ("travel", "final\nerror", "max\nerror", "rms\nerror", "settling\n[s]", "over-\nshoot [%]"):
        table.add_column(heading, justify="right", no_wrap=True, min_width=6)
    for axis in metrics.axes:
        lengths = (axis.travel, axis.final_error, axis.max_error, axis.rms_error)
        table.add_row(
            markup(f"{axis.name} [{axis.unit}]"),
            *(_short(value) for value in lengths),
            "-" if axis.settling_time is None else f"{axis.settling_time:g}",
            "-" if axis.overshoot is None else f"{axis.overshoot:.2f}",
        )
    return table


def _short(value: float) -> str:
    return f"{value:.3g}" if value == 0.0 or value >= 1e-3 else f"{value:.0e}"


def _totals(mode: str, result: RunResult, metrics: RunMetrics, whole_time: float) -> Table:
    table = Table(show_header=False, box=None)
    rows = {
        "saturation share": f"{100 * metrics.saturation_share:.1f} % of periods",
        "momentum residual": f"{metrics.momentum_residual:.1e}",
        "energy residual": f"{metrics.energy_residual:.1e}",
        "integration error": "-" if metrics.integration_error is None else f"{metrics.integration_error:.1e} rad or m",
        "torque integral": f"{metrics.effort_integral:.4g} N m s",
        "joint limits": "kept" if metrics.joint_limit == 0.0 else f"exceeded by {metrics.joint_limit:.3g} rad",
        "simulated time": f"{metrics.simulated_time:g} s",
        "wall time": f"{result.wall_time:.2f} s in {mode} mode, first tick to last",
        "whole time": f"{whole_time:.2f} s, with set-up, log and verdict",
        "x real time": f"{metrics.simulated_time / result.wall_time:.0f}" if result.wall_time else "-",
    }
    for name, value in rows.items():
        table.add_row(name, value)
    return table
