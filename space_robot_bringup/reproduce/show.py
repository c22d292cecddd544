"""A reproduction on a terminal: claim by claim."""

from __future__ import annotations

import re

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_bringup.reproduce.summary import Data
from space_robot_bringup.terminal import markup

STYLES = {"holds": "green", "does not hold": "yellow", "not checkable": "dim", "undecided": "red"}


def show(console: Console, data: Data) -> None:
    """Print every claim with what was measured, then what is not as documented.

    Args:
        console: where to.
        data: see ``summary``.
    """
    console.print(f"{data['title']} ({data['citation']})", style="bold", markup=False, soft_wrap=True)
    for figure in data["figures"]:
        console.print(f"\n{heading(figure)}", style="bold", markup=False, soft_wrap=True)
        for claim in figure["claims"]:
            _claim(console, claim)
        for group, times in figure["timing"].items():
            numbers = f"mean {times['mean']:.1f}, median {times['median']:.1f}, 99 % below {times['p99']:.1f} us"
            console.print(f"  {group}: {numbers} per cycle, {times['repeats']} repeats", markup=False, soft_wrap=True)
        for table in figure["tables"]:
            console.print(_table(table))
        _troubles(console, figure)
    word, style = ("as documented", "bold green") if data["passed"] else ("NOT as documented", "bold red")
    console.print(f"\n{count(data)}: {word}", style=style, markup=False, soft_wrap=True)


def _table(data: Data) -> Table:
    table = Table(title=markup(data["title"]) or None, title_justify="left", box=SIMPLE_HEAD)
    table.add_column("")
    for column in data["columns"]:
        table.add_column(markup(column), justify="right")
    for row, cells in data["rows"].items():
        table.add_row(markup(row), *(_cell(cell, data["digits"]) for cell in cells))
    return table


def _cell(cell: Data, digits: int) -> str:
    """A number; where runs lack it, how many."""
    lacking = f" ({cell['without']} of {cell['runs']} without)" if cell["without"] else ""
    return "-" + lacking if cell["value"] is None else f"{cell['value']:.{digits}g}{lacking}"


def _troubles(console: Console, figure: Data) -> None:
    warned = [run for run in figure["runs"] if run["warnings"]]
    if warned:
        first = f"{warned[0]['label']}: {warned[0]['warnings'][0]}"
        line = f"  warned of {len(warned)} of {len(figure['runs'])} runs before their flight, first {first}"
        console.print(line, style="yellow", markup=False, soft_wrap=True)
    for run in figure["runs"]:
        if run["label"] in figure["failed"]:
            line = f"  failed: {run['label']}: {run['end_reason']}"
            console.print(line, style="red", markup=False, soft_wrap=True)


def heading(figure: Data) -> str:
    """What a figure is called: ``Figure 8``, ``Figures 6-9``, ``Table 2`` for 8, 6-9, table2, else its own name."""
    name = figure["name"]
    if name.isdecimal():
        name = f"Figure {name}"
    elif re.fullmatch(r"\d+-\d+", name):
        name = f"Figures {name}"
    elif table := re.fullmatch(r"table[ -]?(\d+)", name):
        name = f"Table {table[1]}"
    beyond = " (beyond the paper)" if figure["kind"] == "beyond" else ""
    return f"{name}: {figure['title']}{beyond}"


def count(data: Data) -> str:
    """How many claims have which verdict, from how many runs."""
    verdicts = [claim["verdict"] for figure in data["figures"] for claim in figure["claims"]]
    if not verdicts:
        return f"no claims, {data['runs']} runs"
    parts = [f"{verdicts.count(verdict)} {verdict}" for verdict in STYLES if verdict in verdicts]
    return f"{len(verdicts)} claims ({', '.join(parts)}) from {data['runs']} runs"


def sample(claim: Data) -> str:
    """How many runs a claim is about, and which seeds or draws of a campaign they have."""
    runs = "1 run" if claim["runs"] == 1 else f"{claim['runs']} runs"
    sources = [f"{kind} {claim[f'{kind}s']}" for kind in ("seed", "draw") if claim[f"{kind}s"]]
    return ", ".join([runs, *sources])


def _claim(console: Console, claim: Data) -> None:
    console.print(f"  {claim['paper']}", style="italic", markup=False, soft_wrap=True)
    console.print(f"    {claim['verdict']}", style=STYLES[claim["verdict"]], end="", markup=False)
    if claim["found"]:
        text = f": {claim['found']} ({sample(claim)})"
        console.print(text, end="", markup=False, soft_wrap=True)
    console.print()
    for measure in claim["measures"].values():
        if measure["without"]:
            line = f"    {len(measure['without'])} of {measure['runs']} runs lack {measure['quantity']}"
            console.print(f"{line}; missing: {measure['missing']}", markup=False, soft_wrap=True)
    if claim["because"]:
        console.print(f"    {claim['because']}", style="dim", markup=False, soft_wrap=True)
    if claim["changed"]:
        line = f"    CHANGED: documented as {claim['documented']!r}"
        console.print(line, style="bold red", markup=False, soft_wrap=True)
