"""How a comparison looks on a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.terminal import markup
from space_robot_studies.compare.comparison import METRICS, Comparison
from space_robot_studies.compare.tables import COST, LEGEND, cost_text, headings, rows_of


def show(
    console: Console, comparison: Comparison, costs: dict[str, float | None], metrics: Sequence[str] = tuple(METRICS)
) -> None:
    """Print one table per metric, what a cycle costs and why runs ended."""
    console.print(comparison.title or comparison.name, style="bold", markup=False)
    for metric in metrics:
        table = Table(box=SIMPLE_HEAD, title=markup(METRICS[metric]), title_justify="left")
        for place, heading in enumerate(headings(comparison)):
            table.add_column(heading, justify="left" if place < 2 else "right", no_wrap=place < 2)
        for row in rows_of(comparison, metric):
            table.add_row(*map(markup, row))
        console.print(table)
    cost = ", ".join(f"{law} {cost_text(value)}" for law, value in costs.items())
    console.print(f"{COST}: {cost}", markup=False, soft_wrap=True)
    for cell in comparison.cells:
        for reason, count in cell.reasons.items():
            line = f"{cell.law}, {cell.period:g} s: {count} x {reason}"
            console.print(line, markup=False, soft_wrap=True)
    console.print(LEGEND, markup=False, soft_wrap=True)
