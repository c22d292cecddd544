"""What a notebook shows of a run: its verdict and its axes, a table each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.metrics import ROTATIONS, Axis
from space_robot_bringup.modes.run import RunResult

AXES = ("axis", "travel", "final error", "max error", "rms error", "settling [s]", "overshoot [%]")
CHECKS = ("expected of", "wanted", "measured", "")


def run_html(title: str, result: RunResult) -> str:
    """A fragment of HTML; what comes from a file is escaped.

    Args:
        title: of the experiment.
        result: of its run.
    """
    ended = escape(f"{result.conclusion} ({result.end_reason}), {result.directory}")
    head = f"<b>{escape(title)}</b><br>{ended}"
    parts = [f"<p>{head}</p>", _table(CHECKS, map(_check, result.checks))]
    if result.metrics is not None:
        parts.append(_table(AXES, map(_axis, result.metrics.axes)) + f"<p>{escape(ROTATIONS)}</p>")
    parts += [f"<p>remark: {escape(remark.line)}</p>" for remark in result.remarks]
    return f"<div>{''.join(parts)}</div>"


def _check(check: Check) -> tuple[str, ...]:
    return check.name, check.wanted, check.reason or _number(check.measured), check.word


def _axis(axis: Axis) -> tuple[str, ...]:
    numbers = (axis.travel, axis.final_error, axis.max_error, axis.rms_error, axis.settling_time, axis.overshoot)
    return f"{axis.name} [{axis.unit}]", *map(_number, numbers)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = "".join(_row("td", row) for row in rows)
    return f"<table><thead>{_row('th', head)}</thead><tbody>{lines}</tbody></table>"


def _row(tag: str, cells: Iterable[str]) -> str:
    inside = "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{inside}</tr>"
