"""A reproduction on a terminal: claim by claim."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.terminal import markup
from space_robot_studies.reproduce.readings import HOLDS, STUDY
from space_robot_studies.reproduce.summary import STYLES, Data, count, heading, sample

OURS = {True: " (ours)", False: ""}


def show(console: Console, data: Data) -> None:
    """Print every claim with what was measured, then what is not as expected.

    Args:
        console: where to.
        data: see ``summary``.
    """
    console.print(f"{data['title']} ({data['citation']})", style="bold", markup=False, soft_wrap=True)
    for name, choice in open_choices(data).items():
        console.print(
            f"  open: {name}{OURS[choice['ours']]}: {choice['open']}", style="dim", markup=False, soft_wrap=True
        )
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
    word, style = ("as expected", "bold green") if data["passed"] else ("NOT as expected", "bold red")
    console.print(f"\n{count(data)}: {word}", style=style, markup=False, soft_wrap=True)


def _table(data: Data) -> Table:
    table = Table(title=markup(data["title"]) or None, title_justify="left", box=SIMPLE_HEAD)
    for column in ("", "N", *data["columns"]):
        table.add_column(markup(column), justify="right" if column else "left")
    for row, cells in data["rows"].items():
        table.add_row(markup(row), str(data["runs"][row]), *(markup(_cell(cell)) for cell in cells))
    return table


def _cell(cell: Data) -> str:
    """A number with its interval; where runs lack it, how many."""
    lacking = (
        f" ({cell['without']} of {cell['runs']} without)" if cell["without"] and " of " not in cell["text"] else ""
    )
    return str(cell["text"]) + lacking


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
    console.print(f"    {claim['verdict']}", style=STYLES[claim["kind"]], end="", markup=False)
    if not claim["choices"]:
        for one in claim["readings"]:
            console.print(f": {one['found']} ({sample(one)})", end="", markup=False, soft_wrap=True)
    console.print()
    for one in claim["readings"]:
        _reading(console, one)
    if claim["because"]:
        console.print(f"    {claim['because']}", style="dim", markup=False, soft_wrap=True)
    if claim["changed"]:
        line = f"    CHANGED: expected {claim['expected']!r}"
        console.print(line, style="bold red", markup=False, soft_wrap=True)


def _reading(console: Console, one: Data) -> None:
    if one["label"]:
        console.print(f"    {one['label']}: ", end="", markup=False, soft_wrap=True)
        console.print(one["verdict"], style=STYLES[one["verdict"]], end="", markup=False)
        console.print(f": {one['found']} ({sample(one)})", markup=False, soft_wrap=True)
    for measure in one["measures"].values():
        if measure["without"] and (measure["value"] is None or not isinstance(measure["missing"], str)):
            line = f"    {len(measure['without'])} of {measure['runs']} runs lack {measure['quantity']}"
            console.print(f"{line}; missing: {measure['missing']}", markup=False, soft_wrap=True)


def markdown(data: Data) -> str:
    """One row per claim, and under it one per combination of the choices that turn it; then what is open.

    Args:
        data: see ``summary``.
    """
    rows = ["| figure | the paper | verdict | here |", "|---|---|---|---|"]
    claims = [(figure["name"], claim) for figure in data["figures"] for claim in figure["claims"]]
    for name, claim in claims:
        groups = _grouped(claim)
        several = len(groups) > 1
        found = [] if several else [_found(*group) for group in groups.values()]
        here = "; ".join([*found, *filter(None, [claim["because"]])])
        verdict = claim["verdict"] if claim["kind"] in (HOLDS, STUDY) else f"**{claim['verdict']}**"
        rows.append(_row(name, claim["paper"], verdict, here))
        for label, group in groups.items() if several else ():
            rows.append(
                _row("", f"*{label}*", " / ".join(dict.fromkeys(one["verdict"] for one in group)), _found(*group))
            )
    choices = open_choices(data)
    said = [
        f"- **{name}**{OURS[one['ours']]}: {'; '.join(one['values'])}. {one['open']}" for name, one in choices.items()
    ]
    return "\n".join([*rows, *(["", "What is open, and how it is read:", ""] if said else []), *said]) + "\n"


def open_choices(data: Data) -> dict[str, Data]:
    """The choices that claims hang on, each once."""
    claims = (claim for figure in data["figures"] for claim in figure["claims"])
    return {name: choice for claim in claims for name, choice in claim["choices"].items()}


def _grouped(claim: Data) -> dict[str, list[Data]]:
    """Readings by the values of the choices that turn the verdict; of a study by all."""
    names = list(claim["choices"]) if claim["kind"] == STUDY else claim["deciding"]
    groups: dict[str, list[Data]] = {}
    for one in claim["readings"]:
        groups.setdefault(", ".join(f"{name}: {one['values'][name]}" for name in names), []).append(one)
    return groups


def _found(first: Data, *others: Data) -> str:
    more = f"; the first of {1 + len(others)} readings" if others else ""
    return f"{first['found']} ({sample(first)}{more})"


def _row(*cells: str) -> str:
    return f"| {' | '.join(' '.join(cell.split()).replace('|', '&#124;') for cell in cells)} |"
