"""The claims as a Markdown table, for documents."""

from __future__ import annotations

from space_robot_bringup.reproduce.show import sample
from space_robot_bringup.reproduce.summary import Data


def markdown(data: Data) -> str:
    """One row per claim: figure, what the paper says, the verdict, what was measured.

    Args:
        data: see ``summary``.
    """
    rows = ["| figure | the paper | verdict | here |", "|---|---|---|---|"]
    for figure in data["figures"]:
        for claim in figure["claims"]:
            found = f"{claim['found']} ({sample(claim)})" if claim["found"] else ""
            here = "; ".join(filter(None, [found, claim["because"]]))
            rows.append(f"| {' | '.join(map(_cell, (figure['name'], claim['paper'], claim['verdict'], here)))} |")
    return "\n".join(rows) + "\n"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
