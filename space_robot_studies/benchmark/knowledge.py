"""What it costs a law not to know something: points that differ in that alone, compared draw by draw."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from space_robot_studies.benchmark.page import Row
from space_robot_studies.benchmark.ranking import Difference, Standing, compared, differences
from space_robot_studies.benchmark.table import Table
from space_robot_studies.compare.comparison import PERIOD
from space_robot_studies.compare.tables import markdown_table, words

UNKNOWN = "unknown"
NOTHING = "No two points that are measured differ in what is known alone."
KNOWLEDGE = (
    "The mean objective of the tuned law that does not know it, less that of the same law tuned with it known, on the "
    "same draws, with its 95 % interval; **bold**: separated from zero by Wilcoxon's signed-rank test, with Holm's "
    "correction for the laws of the point, and by the interval."
)


def knowledge_of(table: Table, titles: Mapping[str, str]) -> str:
    """A table per thing that a law may know or not.

    Args:
        table: rows under the same rules.
        titles: task to its title.
    """
    keys = dict.fromkeys(key for row in table.rows for key, label in row["point"].items() if label == UNKNOWN)
    laws = list(dict.fromkeys(row["law"] for row in table.rows))
    heads = ("task", "where", "period [s]", *(f"`{law}`" for law in laws))
    parts = []
    for key in keys:
        lines = [
            [titles.get(task) or task, where, period, *(_cell(found.get(law)) for law in laws)]
            for task, where, period, found in _compared(table, key)
        ]
        if lines:
            parts.append(f"**{words({key: 'unknown, less known'})}**\n\n{markdown_table(heads, lines)}")
    return "\n\n".join([KNOWLEDGE, *parts] if parts else [NOTHING]) + "\n"


def known_pairs(table: Table, key: str) -> Iterator[dict[str, tuple[Row, Row]]]:
    """Of each point where something is not known: law to its row there, and its row where that alone is known.

    Args:
        table: rows under the same rules.
        key: of what may be known.
    """
    known = {_place(row, key): row for row in table.rows if row["point"].get(key) != UNKNOWN}
    points: dict[tuple[str, str], list[Row]] = {}
    for row in table.rows:
        if row["point"].get(key) == UNKNOWN:
            points.setdefault(_place(row, key)[:2], []).append(row)
    for _, rows in sorted(points.items()):
        yield {row["law"]: (row, known[place]) for row in rows if (place := _place(row, key)) in known}


def _compared(table: Table, key: str) -> Iterator[tuple[str, str, str, dict[str, Difference]]]:
    """Task, what else is varied in words, period, and law to what not knowing it costs."""
    for both in known_pairs(table, key):
        pairs = {law: off for law, rows in both.items() if (off := differences(*_standings(rows))) is not None}
        if pairs:
            row, _ = next(iter(both.values()))
            point = {name: label for name, label in row["point"].items() if name != key}
            period = str(point.pop(PERIOD, ""))
            yield row["task"], words(point), period, compared(pairs)


def _standings(rows: tuple[Row, Row]) -> tuple[Standing, Standing]:
    without, known = (Standing.of(row["law"], row["tuned"]) for row in rows)
    return without, known


def _place(row: Row, key: str) -> tuple[str, str, str]:
    """Task, all of the point but this key, and law."""
    point = {name: label for name, label in row["point"].items() if name != key}
    return row["task"], json.dumps(point, sort_keys=True), row["law"]


def _cell(one: Difference | None) -> str:
    if one is None:
        return ""
    text = format(one.mean, ".2g")
    return f"**{text}**" if one.apart else text
