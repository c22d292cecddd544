"""A table of results as Markdown: shipped beside tuned, intervals, and what the paired tests allow to be said."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from space_robot_studies.benchmark.ranking import Ranking, Standing, rank
from space_robot_studies.benchmark.table import Table
from space_robot_studies.compare.tables import markdown_table, words
from space_robot_studies.reproduce.estimate import Estimate

Row = Mapping[str, Any]
SHOWN = {"joint_error": "joint error [deg]", "attitude_rms": "attitude, rms [deg]", "torque_integral": "torque [N m s]"}
LEGEND = (
    "Means over the held-out draws with 95 % bootstrap intervals; settled: runs of which every axis came to rest in "
    "its band, where the reference does. Shipped is the law with the gains it is given in the file, tuned the best of "
    "the search. "
    "ended k: k runs did not complete; misses k: k runs are beyond a constraint. "
    "Worse is said where Wilcoxon's signed-rank test over the same draws, with Holm's correction, and the interval of "
    "the mean difference both say so."
)


def page_of(table: Table, titles: Mapping[str, str]) -> str:
    """All tasks of a table.

    Args:
        table: rows under the same rules.
        titles: task to its title.
    """
    rules = table.identity["rules"]
    count, search = rules["held_out"], f"{rules['budget']} evaluations of {rules['draws']} draws"
    head = (
        f"Benchmark version {table.identity['version']}; per law and point {search}, judged on {count} held-out draws."
    )
    parts = [head, LEGEND]
    for task in dict.fromkeys(row["task"] for row in table.rows):
        parts.append(f"### {titles.get(task) or task}")
        for rows in points_of(table, task):
            where = words(rows[0]["point"])
            parts += [f"**{where}**"] if where else []
            parts += [markdown_table(HEADINGS, cells_of(rows)), sentence(rank(standings(rows)))]
    return "\n\n".join(parts) + "\n"


HEADINGS = (
    "law",
    "objective, shipped",
    "objective, tuned",
    "settled, shipped",
    "settled, tuned",
    *(f"{one}, tuned" for one in SHOWN.values()),
)


def points_of(table: Table, task: str) -> list[list[Row]]:
    """The rows of a task, point by point, in the order of their labels."""
    found: dict[str, list[Row]] = {}
    for row in table.rows:
        if row["task"] == task:
            found.setdefault(json.dumps(row["point"], sort_keys=True), []).append(row)
    return [found[key] for key in sorted(found)]


def standings(rows: Sequence[Row]) -> list[Standing]:
    """The tuned laws of a point."""
    return [Standing.of(row["law"], row["tuned"]) for row in rows]


def cells_of(rows: Sequence[Row]) -> list[list[str]]:
    """A row of text per law, in the order of ``HEADINGS``."""
    found = []
    for row in rows:
        shipped, tuned = Standing.of(row["law"], row["shipped"]), Standing.of(row["law"], row["tuned"])
        marks = " overfitted" if row["overfitted"] else ""
        found.append(
            [
                f"`{row['law']}`",
                _objective(shipped),
                _objective(tuned) + marks,
                _settled(shipped, row),
                _settled(tuned, row),
                *(_number(tuned.mean(name)) for name in SHOWN),
            ]
        )
    return found


def sentence(ranking: Ranking) -> str:
    """What may be said of a point."""
    if ranking.best is None:
        return "No law completed every draw within the constraints."
    said = [f"Least objective: `{ranking.best}`."]
    if ranking.equal:
        said.append(f"Not separated from it: {_names(ranking.equal)}.")
    if ranking.worse:
        differences = (f"`{law}` by {difference:.3g}" for law, difference in ranking.worse.items())
        said.append(f"Worse: {', '.join(differences)}.")
    if ranking.failed:
        said.append(f"Not in every draw: {_names(ranking.failed)}.")
    return " ".join(said)


def _names(laws: Sequence[str]) -> str:
    return ", ".join(f"`{law}`" for law in laws)


def _settled(one: Standing, row: Row) -> str:
    return f"{one.settled}/{len(one.draws)}" if row["settles"] else "-"


def _objective(one: Standing) -> str:
    """Mean with interval, or how many runs did not come to one."""
    ended = sum(draw["objective"] is None for draw in one.draws)
    missed = sum(bool(draw["excess"]) for draw in one.draws)
    marks = [f"{word} {count}" for word, count in (("ended", ended), ("misses", missed)) if count]
    text = _number(one.mean("objective")) if not ended else ""
    return " ".join([*([text] if text else []), *([f"({', '.join(marks)})"] if marks else [])])


def _number(value: Estimate | None) -> str:
    return "-" if value is None else format(value, ".3g")
