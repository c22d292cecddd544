"""What all commands share: the application, its two consoles, exit codes and common options."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from space_robot_cli.output import Output
from space_robot_cli.panels import PanelGroup

FAILED, BAD_INPUT = 1, 2

app = typer.Typer(
    cls=PanelGroup,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    epilog="Exit codes: 0 fine, also where nothing was expected, 1 the run failed its verdict, 2 bad input or usage.",
)
if TYPE_CHECKING:
    from space_robot_cli.terminal import PlainConsole

    out = err = PlainConsole()
else:
    out, err = Output(), Output(stderr=True)

SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="override one key, e.g. controller.gains.damping=0.7"),
]
FaultOption = Annotated[
    list[str] | None,
    typer.Option(
        "--fault",
        metavar="'KIND KEY=VALUE ...'",
        help="let something go wrong, e.g. 'joint_stuck joint=joint2 at=20'; kinds and keys: list faults",
    ),
]
LawOption = Annotated[
    list[str] | None,
    typer.Option(
        "--law",
        metavar="[NAME=]FILE:Class",
        help="the law to use where the data names custom code; NAME: which one of several",
    ),
]
AllowCodeOption = Annotated[
    bool, typer.Option("--allow-code", help="run the code the data names; only for data whose maker you trust")
]
JunitOption = Annotated[
    Path | None,
    typer.Option(
        "--junit", metavar="FILE", help="also write JUnit XML, a test case per expectation, run or comparison"
    ),
]
NamespaceOption = Annotated[str, typer.Option(help="in front of the topics of a bag of another tool")]
StartOption = Annotated[
    str,
    typer.Option(help="what stamps in a bag of another tool count from: run, or first, its first state (since 1970)"),
]
JsonOption = Annotated[bool, typer.Option("--json", help="print one JSON object on stdout and nothing else there")]


def _show_version(asked: bool) -> None:
    if asked:
        from space_robot_msgs_py.version import __version__

        print(f"space-robot {__version__}")
        raise typer.Exit


@app.callback()
def tool(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", is_eager=True, callback=_show_version)
    ] = False,
) -> None:
    """Flight software of a space robot, emulated: run experiments, record them, look at robots."""


def warn(warning: str) -> None:
    """Say on stderr what a law warns of."""
    err.print(f"warning: {warning}", style="yellow", markup=False, soft_wrap=True)
