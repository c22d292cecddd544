"""All points of a table in one: a line per point, a column per law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from space_robot_studies.benchmark.page import Row, points_of, standings
from space_robot_studies.benchmark.ranking import Standing, rank
from space_robot_studies.benchmark.table import Table
from space_robot_studies.compare.comparison import PERIOD
from space_robot_studies.compare.tables import markdown_table, words

OVERVIEW = (
    "The mean objective of the tuned law over that of the best law of the point; **bold**: not separated from the best "
    "one; in brackets: held-out draws that did not complete or miss a constraint, of which a law has no rank."
)


def overview_of(table: Table, titles: Mapping[str, str]) -> str:
    """A line per point.

    Args:
        table: rows under the same rules.
        titles: task to its title.
    """
    laws = list(dict.fromkeys(row["law"] for row in table.rows))
    lines = []
    for task in dict.fromkeys(row["task"] for row in table.rows):
        for rows in points_of(table, task):
            point = dict(rows[0]["point"])
            period = str(point.pop(PERIOD, ""))
            cells = _cells(rows)
            lines.append([titles.get(task) or task, words(point), period, *(cells.get(law, "") for law in laws)])
    heads = ("task", "where", "period [s]", *(f"`{law}`" for law in laws))
    return f"{OVERVIEW}\n\n{markdown_table(heads, lines)}\n"


def _cells(rows: Sequence[Row]) -> dict[str, str]:
    """Law to its cell, at a point."""
    stands = standings(rows)
    ranking = rank(stands)
    best = next((mean for one in stands if one.law == ranking.best and (mean := _mean(one)) is not None), None)
    first = {ranking.best, *ranking.equal}
    return {one.law: _cell(one, best, one.law in first) for one in stands}


def _cell(one: Standing, best: float | None, first: bool) -> str:
    if not one.whole:
        return f"({sum(draw['objective'] is None or bool(draw['excess']) for draw in one.draws)}/{len(one.draws)})"
    mean = _mean(one)
    assert mean is not None
    assert best is not None
    text = f"{mean / best:.3g}"
    return f"**{text}**" if first else text


def _mean(one: Standing) -> float | None:
    found: Any = one.mean("objective")
    return None if found is None else float(found.value)
