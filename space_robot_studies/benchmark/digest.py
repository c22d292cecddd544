"""What a whole table comes to: medians over points, by period, by task, and of what knowledge is worth."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import NamedTuple

from space_robot_studies.benchmark.knowledge import UNKNOWN, known_pairs
from space_robot_studies.benchmark.page import points_of, standings
from space_robot_studies.benchmark.ranking import Standing, compared, differences, rank
from space_robot_studies.benchmark.table import Table
from space_robot_studies.compare.comparison import PERIOD
from space_robot_studies.compare.tables import markdown_table, words

BY_PERIOD = (
    "Per law and control period the median, over all points, of its mean objective over that of the best law of the "
    "point; in brackets the points where it is not separated from the best one, of all that it was tuned at. No rank: "
    "points with a held-out draw that did not complete or misses a constraint; they do not enter medians. Gained: the "
    "median of the objective with the gains it is given over that with those of the search. At an edge: points whose "
    "best gains lie at the end of a range."
)
BRIEF = (
    "Per law and control period the median, over {points} points, of its mean objective over that of the best law of "
    "the point; in brackets the points where it is not separated from the best one."
)
BY_TASK = "The same by task, over all periods."
OF_KNOWLEDGE = (
    "Per law the median, over points, of the mean objective without over that with the knowledge; in brackets the "
    "points where the law is separated for the worse and for the better without it, of those that can be compared."
)


class Place(NamedTuple):
    """A law at a point: ``ratio`` to the best one and ``gained`` are None where it has no rank."""

    law: str
    task: str
    period: str
    ratio: float | None
    first: bool
    gained: float | None
    edge: bool


@dataclass
class Worth:
    """What a law makes of knowledge: its ratios without over with it, and how many are separated each way."""

    ratios: list[float] = field(default_factory=list)
    worse: int = 0
    better: int = 0


def digest_of(table: Table, titles: Mapping[str, str]) -> str:
    """Three tables with a line per law.

    Args:
        table: rows under the same rules.
        titles: task to its title.
    """
    places = list(_places(table))
    laws, tasks = (list(dict.fromkeys(names)) for names in zip(*((one.law, one.task) for one in places), strict=True))
    lines = []
    for law in laws:
        groups = ([place for place in places if (place.law, place.task) == (law, task)] for task in tasks)
        lines.append([f"`{law}`", *map(_middle, groups)])
    by_task = markdown_table(["law", *(titles.get(task) or task for task in tasks)], lines)
    return (
        "\n\n".join([BY_PERIOD, markdown_table(*_periods(places)), BY_TASK, by_task, *_knowledge(table, laws)]) + "\n"
    )


def brief_of(table: Table, titles: Mapping[str, str]) -> str:
    """The ratios of the first of the tables; see ``digest_of``."""
    heads, lines = _periods(list(_places(table)))
    caption = BRIEF.format(points=len({(row["task"], json.dumps(row["point"], sort_keys=True)) for row in table.rows}))
    ratios = [cells[: heads.index("all") + 1] for cells in (heads, *lines)]
    return f"{caption}\n\n{markdown_table(ratios[0], ratios[1:])}\n"


def _periods(places: Sequence[Place]) -> tuple[list[str], list[list[str]]]:
    """Headings, and a line per law."""
    laws = dict.fromkeys(place.law for place in places)
    periods = sorted({place.period for place in places}, key=float)
    lines = []
    for law in laws:
        own = [place for place in places if place.law == law]
        groups = ([place for place in own if place.period == period] for period in periods)
        counts = (sum(flags) for flags in ([place.ratio is None for place in own], [place.edge for place in own]))
        unranked, edge = map(str, counts)
        gained = _median([place.gained for place in own])
        lines.append([f"`{law}`", *map(_counted, groups), _counted(own), unranked, gained, edge])
    return ["law", *(f"{period} s" for period in periods), "all", "no rank", "gained", "at an edge"], lines


def _places(table: Table) -> Iterator[Place]:
    for task in dict.fromkeys(row["task"] for row in table.rows):
        for rows in points_of(table, task):
            stands = standings(rows)
            ranking = rank(stands)
            means = {one.law: _mean(one) for one in stands if one.whole}
            best, first = means.get(ranking.best or ""), (ranking.best, *ranking.equal)
            for row, law in zip(rows, (one.law for one in stands), strict=True):
                given, mean = Standing.of(law, row["shipped"]), means.get(law)
                gained = None if mean is None or not given.whole else _mean(given) / mean
                ratio = None if mean is None or best is None else mean / best
                period = str(row["point"].get(PERIOD, ""))
                yield Place(law, task, period, ratio, law in first, gained, bool(row["edge"]))


def _mean(one: Standing) -> float:
    found = one.mean("objective")
    assert found is not None
    return float(found.value)


def _middle(places: Sequence[Place]) -> str:
    return _median([place.ratio for place in places])


def _median(values: Sequence[float | None]) -> str:
    known = [value for value in values if value is not None]
    return f"{median(known):.3g}" if known else "-"


def _counted(places: Sequence[Place]) -> str:
    return f"{_middle(places)} ({sum(place.first for place in places)}/{len(places)})"


def _knowledge(table: Table, laws: Sequence[str]) -> Iterator[str]:
    keys = dict.fromkeys(key for row in table.rows for key, label in row["point"].items() if label == UNKNOWN)
    worth = {key: _worth(table, key) for key in keys}
    worth = {key: found for key, found in worth.items() if found}
    if worth:
        yield OF_KNOWLEDGE
        heads = ["law", *(words({key: UNKNOWN}) for key in worth)]
        yield markdown_table(
            heads, [[f"`{law}`", *(_said(found.get(law)) for found in worth.values())] for law in laws]
        )


def _worth(table: Table, key: str) -> dict[str, Worth]:
    found: dict[str, Worth] = {}
    for pairs in known_pairs(table, key):
        stands = {law: tuple(Standing.of(law, one["tuned"]) for one in both) for law, both in pairs.items()}
        compare = {law: off for law, both in stands.items() if (off := differences(*both)) is not None}
        for law, difference in compared(compare).items():
            without, known = stands[law]
            worth = found.setdefault(law, Worth())
            worth.ratios.append(_mean(without) / _mean(known))
            worth.worse += difference.apart and difference.mean.value > 0.0
            worth.better += difference.apart and difference.mean.value < 0.0
    return found


def _said(worth: Worth | None) -> str:
    if worth is None:
        return "-"
    return f"{median(worth.ratios):.3g} ({worth.worse} and {worth.better} of {len(worth.ratios)})"
