"""A reproduction on a terminal: claim by claim."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.terminal import markup
from space_robot_studies.reproduce.summary import STYLES, Data, count, heading, sample


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
        line = f"  warned of {len(warned)} of {len(figure['runs'])} runs before their run, first {first}"
        console.print(line, style="yellow", markup=False, soft_wrap=True)
    for run in figure["runs"]:
        if run["label"] in figure["failed"]:
            line = f"  failed: {run['label']}: {run['end_reason']}"
            console.print(line, style="red", markup=False, soft_wrap=True)


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
            rows.append(
                f"| {' | '.join(map(_markdown_cell, (figure['name'], claim['paper'], claim['verdict'], here)))} |"
            )
    return "\n".join(rows) + "\n"


def _markdown_cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
