"""The comparison as tables of text: a row per law and condition, a column per period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from space_robot_studies.compare.comparison import METRICS, Cell, Comparison

LEGEND = (
    "Medians over the completed runs that have the number. (k/N): only k of N runs settled. "
    "ended n: so many runs ended before their time; no number of theirs counts."
)
COST = "median of one update [us], wall clock of this machine"


def rows_of(comparison: Comparison, metric: str) -> list[list[str]]:
    """The cells of a metric as text: law, condition, then the periods."""
    return [
        [law, words(condition), *(text(comparison.cell(law, t, condition), metric) for t in comparison.periods)]
        for condition in comparison.conditions
        for law in comparison.laws
    ]


def headings(comparison: Comparison) -> list[str]:
    """Of the columns of ``rows_of``."""
    return ["law", "condition", *(f"{period:g} s" for period in comparison.periods)]


def text(cell: Cell, metric: str) -> str:
    """One cell; what failed is said in it."""
    value = cell.medians[metric]
    ended = [f"ended {cell.ended}"] if cell.ended else []
    if value is None:
        return ", ".join([f"{cell.settled}/{cell.runs}", *ended])
    marks = [f"{cell.settled}/{cell.runs}", *ended] if cell.settled < cell.runs else []
    return f"{value:.3g}" + (f" ({', '.join(marks)})" if marks else "")


def words(condition: Mapping[str, Any]) -> str:
    """A condition in few words: the last part of each key and its label."""
    return ", ".join(f"{key.rpartition('.')[2].replace('_', ' ')}: {label}" for key, label in condition.items())


def markdown(comparisons: Sequence[Comparison], costs: Mapping[str, Mapping[str, float | None]]) -> str:
    """All metrics of all comparisons, and what a cycle costs.

    Args:
        comparisons: one per campaign.
        costs: campaign to law to its cost [us].
    """
    parts = [LEGEND]
    for comparison in comparisons:
        parts.append(f"## {comparison.title or comparison.name}")
        for metric, what in METRICS.items():
            parts += [f"### {what}", markdown_table(headings(comparison), rows_of(comparison, metric))]
        cost = [[law, cost_text(value)] for law, value in costs[comparison.name].items()]
        parts += ["### cost per cycle", markdown_table(["law", COST], cost)]
    return "\n\n".join(parts) + "\n"


def cost_text(value: float | None) -> str:
    """A cost; a law that ended its run at once has none."""
    return "-" if value is None else f"{value:.0f}"


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of Markdown, whatever its cells say."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
