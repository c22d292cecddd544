"""A run that is shown while it goes on: `run --view` and `run --foxglove`."""

from __future__ import annotations

import webbrowser
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from space_robot_cli.app import err
from space_robot_msgs_py.errors import SpecError

if TYPE_CHECKING:
    from space_robot_bringup.compose.composition import Composition

FoxgloveOption = Annotated[
    int | None,
    typer.Option(
        "--foxglove",
        metavar="PORT",
        help="serve it to Foxglove on 127.0.0.1 while it runs (8765 is where Foxglove looks)",
        min=1,
        max=65535,
    ),
]


@dataclass(frozen=True, slots=True)
class Live:
    """Where a run is shown.

    Attributes:
        title: of the run.
        view: port of the viewer; None: there is none.
        foxglove: port for Foxglove; None: there is none.
        own: the user has the robot, not only a log of it: its meshes may be read where it says they are.
        open_browser: open a tab.
    """

    title: str
    view: int | None
    foxglove: int | None
    own: bool
    open_browser: bool


def check_live(mode: str, foxglove: int | None) -> None:
    """Refuse to serve what is no graph.

    Raises:
        SpecError: it is none.
    """
    if mode == "headless" and foxglove is not None:
        raise SpecError("has no graph", key="--foxglove", value=foxglove, accepted="--mode graph or processes")


def folders_of(urdf: str, *, own: bool) -> Sequence[Path]:
    """Folders of meshes that may be read: those of a robot of the user; of any other, what any log may show."""
    from space_robot_description.share import mesh_folders

    return mesh_folders(urdf) if own else ()


@contextmanager
def shown(composition: Composition, mode: str, live: Live) -> Iterator[None]:
    """While in the block, the run is shown; a headless one is over before a browser is there.

    Raises:
        SpecError: something is not installed, or a port is taken.
    """
    if mode == "headless" or (live.view is None and live.foxglove is None):
        yield
        return
    from space_robot_report.live.brief import Brief
    from space_robot_report.live.companion import shown_live

    experiment, header = composition.experiment, composition.header
    brief = Brief(
        title=live.title,
        about=f"{experiment.title or live.title}, law {experiment.controller.law}",
        joint_names=header.joint_names,
        urdf=header.urdf,
        topics=header.topics,
        tool=composition.nominal.tool_frame,
        meshes=tuple(map(str, folders_of(header.urdf, own=live.own))),
        view=live.view,
        foxglove=live.foxglove,
    )
    with shown_live(brief) as addresses:
        for name, address in addresses.items():
            err.print(f"{name}: {address} while it runs", markup=False, soft_wrap=True)
        if live.open_browser:
            webbrowser.open(addresses["view"])
        yield
