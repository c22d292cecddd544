"""The command line: it parses, calls the library and prints; nothing else.

Imports of the library stand inside the commands: numba and Pinocchio take a second to load, and ``--help`` needs none.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from typing import Annotated, Never

import typer

import space_robot_cli.log_commands
import space_robot_cli.run_command
import space_robot_cli.study_commands  # noqa: F401  (their commands belong to the same application)
from space_robot_bringup.modes.signals import Interrupted, raising
from space_robot_cli.app import (
    BAD_INPUT,
    FAILED,
    FaultOption,
    JsonOption,
    SetOption,
    app,
    err,
    out,
    warn,
)
from space_robot_cli.completion import choices, shipped_names
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import SpaceRobotError

LISTED = ("experiments", "papers", "campaigns", "tuning", "benchmarks", "supervision", "robots", "laws", "faults")
FILES, STARTS = ("experiment", "campaign", "paper"), ("experiment", "law", "robot", "study")
# What typer makes of a KeyboardInterrupt.
INTERRUPTED = 130


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
        out.print(heading, style="bold")
        for shipped, title in rows.items():
            out.print(f"  {shipped:<34}{title}", markup=False, soft_wrap=True)


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
    from space_robot_cli.check import check_file, kind_of

    try:
        checked = check_file(file, kind or kind_of(file), set_ or (), err.print, faults=fault or ())
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
    from space_robot_cli.render import run as render
    from space_robot_description.load import load_robot
    from space_robot_description.report import robot_report

    report = robot_report(load_robot(file))
    if as_json:
        print(json.dumps(report.to_dict(), allow_nan=False))
    else:
        render.robot(out, report)
        for warning in report.warnings:
            warn(warning)


@app.command()
def schema(
    kind: Annotated[
        str, typer.Argument(help="experiment, campaign or paper", autocompletion=choices(FILES))
    ] = "experiment",
) -> None:
    """Print the JSON schema of a kind of file, for editors."""
    from space_robot_cli.check import schema_of

    print(json.dumps(schema_of(kind), indent=2))


@app.command()
def new(
    kind: Annotated[str, typer.Argument(help="experiment, law, robot or study", autocompletion=choices(STARTS))],
    name: Annotated[Path, typer.Argument(help="of the file, e.g. my_law")],
) -> None:
    """Write a working, commented start for a file of your own."""
    from space_robot_cli.new import write_new

    for path in write_new(kind, name):
        out.print(f"written: {path}", markup=False, soft_wrap=True)


def main() -> Never:
    """Entry point: one line per error, exit 2 on bad input, 1 on a signal, no traceback."""
    try:
        with raising(signal.SIGINT, signal.SIGTERM):
            # Without standalone mode an Exit of a command is what app returns.
            code = app(prog_name="space-robot", standalone_mode=False)
    except SpaceRobotError as error:
        err.print(f"space-robot: {error}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except (Interrupted, KeyboardInterrupt, typer.Abort) as error:
        err.print(f"space-robot: {error.reason if isinstance(error, Interrupted) else 'interrupted'}", markup=False)
        sys.exit(FAILED)
    except BrokenPipeError:
        # The reader of stdout is gone, as after `| head`; nothing more can be printed, at the exit neither.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(FAILED)
    except OSError as error:
        # What the system refuses of a path that was typed: too long a name, no permission.
        place = f"{short(str(error.filename))}: " if error.filename is not None else ""
        err.print(f"space-robot: {place}{error.strerror or error}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except Exception as error:
        # Usage errors of the parser know how to show themselves; anything else is a bug and shows its trace.
        show = getattr(error, "format_message", None)
        if show is None:
            raise
        if type(error).__name__ == "NoArgsIsHelpError":
            err.print(show(), markup=False)
            sys.exit(BAD_INPUT)
        err.print(f"space-robot: {show()}; see --help", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    if code == INTERRUPTED:
        err.print("space-robot: interrupted", style="red", markup=False)
        sys.exit(FAILED)
    sys.exit(code or 0)
