"""The commands that prepare a run: check, new, list, robot, schema.

Imports of the library stand inside the commands: what a command does not need costs it no time.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from space_robot_cli.app import BAD_INPUT, FaultOption, JsonOption, SetOption, app, err, out, warn
from space_robot_cli.completion import choices, shipped_names
from space_robot_msgs_py.errors import SpaceRobotError

LISTED = ("experiments", "papers", "campaigns", "tuning", "benchmarks", "supervision", "robots", "laws", "faults")
FILES, STARTS = ("experiment", "campaign", "paper"), ("experiment", "law", "robot", "study")


@app.command("list")
def list_shipped(
    kind: Annotated[
        str,
        typer.Argument(
            help=f"{', '.join(LISTED[:-1])} or {LISTED[-1]}; default: all but the last two",
            autocompletion=choices(LISTED),
        ),
    ] = "",
    name: Annotated[str, typer.Argument(help="only names that begin with this, e.g. liu2023")] = "",
) -> None:
    """List what is shipped, and explain laws and faults."""
    from space_robot_cli.catalogue import EXPLAINED, catalogue

    if kind in EXPLAINED:
        for line in EXPLAINED[kind](name):
            out.print(line, markup=False, soft_wrap=True)
        return
    for heading, rows in catalogue(kind, name).items():
        out.print(heading, style="bold", markup=False, soft_wrap=True)
        lines = [f"  {shipped:<34}{title}" for shipped, title in rows.items()]
        out.print("\n".join(lines), markup=False, soft_wrap=True)


@app.command()
def check(
    file: Annotated[
        str,
        typer.Argument(
            help="experiment, campaign or paper: shipped name or YAML file",
            autocompletion=shipped_names("experiments", "campaigns", "papers"),
        ),
    ],
    set_: SetOption = None,
    fault: FaultOption = None,
    kind: Annotated[
        str,
        typer.Option(help="experiment, campaign or paper; default: what it looks like", autocompletion=choices(FILES)),
    ] = "",
) -> None:
    """Check an experiment, campaign or paper without running it."""
    from space_robot_description.kernel.choice import interpret

    # To load a compiler takes longer than the few calls of kernels that a check makes.
    interpret()
    from space_robot_cli.check import check_file
    from space_robot_cli.kinds import kind_of

    try:
        checked = check_file(file, kind or kind_of(file), set_ or (), fault or ())
    except SpaceRobotError as error:
        for problem in error.problems or (error,):
            err.print(f"space-robot: {problem}", style="red", markup=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None
    out.print(f"{file}: fine. {checked.summary}", markup=False, soft_wrap=True)
    for line in checked.facts:
        out.print(f"  {line}", markup=False, soft_wrap=True)
    for warning in checked.warnings:
        warn(warning)


@app.command()
def robot(
    file: Annotated[str, typer.Argument(help="shipped name or YAML file", autocompletion=shipped_names("robots"))],
    as_json: JsonOption = False,
) -> None:
    """Print mass, inertia, momentum, reach, coupling of a robot.

    The coupling is the condition of the part of the mass matrix that ties the base to the arm.
    """
    from space_robot_cli.render import robot as render
    from space_robot_description.load import load_robot
    from space_robot_description.report import robot_report

    report = robot_report(load_robot(file))
    if as_json:
        print(json.dumps(report.to_dict(), allow_nan=False))
    else:
        render.show(out, report)
        for warning in report.warnings:
            warn(warning)


@app.command()
def schema(
    kind: Annotated[
        str, typer.Argument(help="experiment, campaign or paper", autocompletion=choices(FILES))
    ] = "experiment",
) -> None:
    """Print the JSON schema of a kind of file, for editors."""
    from space_robot_cli.schemas import schema_text

    print(schema_text(kind), end="")


@app.command()
def new(
    kind: Annotated[str, typer.Argument(help="experiment, law, robot or study", autocompletion=choices(STARTS))],
    name: Annotated[Path, typer.Argument(help="of the file, e.g. my_law")],
) -> None:
    """Write a working, commented start for a file of your own."""
    from space_robot_cli.new import write_new

    for path in write_new(kind, name):
        out.print(f"written: {path}", markup=False, soft_wrap=True)
