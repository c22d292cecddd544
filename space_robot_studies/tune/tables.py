"""A tuning as tables of text."""

from __future__ import annotations

from space_robot_studies.compare.tables import markdown_table
from space_robot_studies.tune.outcome import StandResult, TuningResult, estimate, number
from space_robot_studies.tune.ranking import Evaluation

HEADINGS = ("law", "shipped", "tuned", "shipped, held out", "tuned, held out", "gains")
LEGEND = (
    "The objective: on the draws of the search, then its mean on the held-out draws with a 95 % bootstrap interval. "
    "misses: beyond a constraint; ended n: so many runs did not complete; overfitted: the held-out draws say otherwise "
    "than those of the search; edge: at an end of its range, a wider one may hold a better value."
)


def rows_of(result: TuningResult) -> list[list[str]]:
    """A row per law and point, in the order of ``HEADINGS``."""
    return [
        [
            stand.where,
            seen(stand.evaluations[0]),
            seen(stand.best),
            unseen(stand.held_out_shipped),
            unseen(stand.held_out_best) + (" overfitted" if stand.overfitted else ""),
            gains_of(stand),
        ]
        for stand in result.stands
    ]


def seen(one: Evaluation) -> str:
    """An evaluation of the search."""
    return number(one.objective) + remark(one)


def unseen(one: Evaluation) -> str:
    """A setting on the held-out draws."""
    return ("none" if one.estimate is None else estimate(one.estimate)) + remark(one)


def remark(one: Evaluation) -> str:
    """What is wrong with an evaluation."""
    if one.failed:
        return f" (ended {one.failed}/{len(one.draws)})"
    return " (misses)" if one.excess else ""


def gains_of(stand: StandResult) -> str:
    """The best gains in few digits."""
    edges = stand.at_the_edge
    words = (f"{name} {value:.3g}{' (edge)' if name in edges else ''}" for name, value in stand.best.gains.items())
    return ", ".join(words) or "as shipped"


def markdown(result: TuningResult) -> str:
    """The table of all laws and points."""
    return f"{LEGEND}\n\n{markdown_table(HEADINGS, rows_of(result))}\n"
