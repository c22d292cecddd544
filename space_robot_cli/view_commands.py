"""The commands that show what happened: a page of a log or a campaign, and a log in the browser."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from space_robot_cli.app import NamespaceOption, StartOption, app, err, out
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install

PortOption = Annotated[int, typer.Option(help="of the viewer; the next free one if it is taken", min=1, max=65535)]
NoBrowserOption = Annotated[bool, typer.Option("--no-browser", help="only print the address")]


ExperimentOption = Annotated[
    str | None, typer.Option(help="for bags of another tool: shipped name or YAML file of what the bag lacks")
]
MeshesOption = Annotated[
    list[Path] | None,
    typer.Option("--meshes", metavar="DIR", help="draw meshes of the log's robot in this folder, too; may repeat"),
]


@app.command()
def report(
    place: Annotated[Path, typer.Argument(help="run directory, bag of any tool, or directory of a campaign")],
    page: Annotated[Path | None, typer.Option("--out", "-o", help="the page; default: beside it, NAME.html")] = None,
    meshes: MeshesOption = None,
    experiment: ExperimentOption = None,
    namespace: NamespaceOption = "",
    start: StartOption = "run",
) -> None:
    """Write a page of a run or campaign: verdict, plots, 3-D.

    It works offline. Of a campaign it says what it adds up to.
    """
    from space_robot_description.share import is_file
    from space_robot_studies.campaign.directory import CAMPAIGN

    target = page or beside(place, ".html")
    if os.path.isdir(target):
        raise SpecError("is a directory", key="--out", value=str(target), accepted="the name of a page")
    try:
        if is_file(place / CAMPAIGN):
            from space_robot_report.pages.campaign_report import write_campaign_report

            done = write_campaign_report(place, target)
            out.print(f"page: {target} ({done} cases)", markup=False, soft_wrap=True)
            return
        from space_robot_bringup.logs.foreign_bag import Source
        from space_robot_report.pages.log_report import write_log_report
    except ImportError as error:
        accepted = install("viz,campaign")
        raise SpecError(f"report needs plotly and more ({error})", accepted=accepted) from None
    source = Source(namespace, start)
    for trouble in write_log_report(place, target, meshes or (), experiment=experiment, source=source).troubles:
        err.print(f"warning: {trouble}", style="yellow", markup=False, soft_wrap=True)
    out.print(f"page: {target}", markup=False, soft_wrap=True)


@app.command()
def view(
    log: Annotated[Path, typer.Argument(help="run directory, or bag of any tool")],
    port: PortOption = 8080,
    no_browser: NoBrowserOption = False,
    meshes: MeshesOption = None,
    experiment: ExperimentOption = None,
    namespace: NamespaceOption = "",
    start: StartOption = "run",
    rerun: Annotated[
        Path | None, typer.Option("--rerun", metavar="FILE.rrd", help="write a recording for Rerun instead")
    ] = None,
) -> None:
    """Show a log in the browser, until Ctrl-C.

    The robot, what was desired, torques, the way of the tool.
    """
    from space_robot_bringup.logs.foreign_bag import Source

    given = {"experiment": experiment, "source": Source(namespace, start)}
    if rerun is not None:
        _write_rerun(log, rerun, meshes or (), **given)
        return
    show_log(log, port=port, open_browser=not no_browser, meshes=meshes or (), **given)


@app.command()
def plot(
    log: Annotated[Path, typer.Argument(help="run directory or .mcap file")],
    picture: Annotated[Path | None, typer.Option("--out", "-o", help="image file; default LOG.png")] = None,
) -> None:
    """Draw attitude, joints and torques of a log to a file."""
    try:
        from space_robot_report.figures.log import draw
    except ImportError as error:
        raise SpecError(f"plot needs matplotlib ({error})", accepted=install("viz")) from None
    place = picture or beside(log, ".png")
    draw(log, place)
    out.print(f"picture: {place}", markup=False, soft_wrap=True)


@app.command()
def video(
    log: Annotated[Path, typer.Argument(help="run directory or .mcap file")],
    film: Annotated[
        Path | None, typer.Option("--out", "-o", help="FILE.gif, or FILE.mp4 with ffmpeg; default: beside it, LOG.gif")
    ] = None,
    seconds: Annotated[float, typer.Option(help="how long it lasts, however long the run was")] = 8.0,
    fps: Annotated[int, typer.Option(help="frames per second")] = 15,
) -> None:
    """Write a film of a run: the robot as lines, GIF or MP4.

    Where it should be is grey; the way of its tool is drawn.
    """
    try:
        from space_robot_report.figures.video import film as write_film
    except ImportError as error:
        raise SpecError(f"video needs matplotlib ({error})", accepted=install("viz")) from None
    place = film or beside(log, ".gif")
    frames = write_film(log, place, seconds=seconds, fps=fps)
    out.print(f"film: {place} ({frames} frames)", markup=False, soft_wrap=True)


@app.command()
def export(
    log: Annotated[Path, typer.Argument(help="run directory or .mcap file")],
    table: Annotated[
        Path | None, typer.Option("--out", "-o", help="FILE.csv or FILE.parquet; default: beside it, LOG.csv")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace a file that is there")] = False,
) -> None:
    """Write a log as a table: CSV or Parquet, a row per tick.

    Columns are named as in Python: base.position.x, joints.position.JOINT.
    """
    from space_robot_bringup.public.export import write_table

    place = write_table(log, table or beside(log, ".csv"), overwrite=overwrite)
    out.print(f"table: {place}", markup=False, soft_wrap=True)


def show_log(log: Path, *, port: int, open_browser: bool, meshes: Sequence[Path] = (), **bag: Any) -> None:
    """Serve a log until Ctrl-C; ``bag``: see ``load_show``.

    Raises:
        SpecError: viser is not installed.
    """
    from space_robot_bringup.modes.signals import StopFlag

    try:
        from space_robot_report.viewer.load import load_show
        from space_robot_report.viewer.serve import serve
    except ImportError as error:
        raise SpecError(f"view needs viser ({error})", accepted=install("view")) from None
    show, troubles = load_show(log, meshes, **bag)
    for trouble in troubles:
        err.print(f"warning: {trouble}", style="yellow", markup=False, soft_wrap=True)
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        serve(
            show,
            port=port,
            open_browser=open_browser,
            on_ready=_announce,
            stop=lambda: stop.reason,
        )


def _write_rerun(log: Path, target: Path, meshes: Sequence[Path], **bag: Any) -> None:
    try:
        from space_robot_bringup.logs.foreign_log import read_shown
        from space_robot_report.rerun_recording import write_rerun
    except ImportError as error:
        raise SpecError(f"--rerun needs the Rerun SDK ({error})", accepted=install("rerun")) from None
    for trouble in write_rerun(read_shown(log, **bag), target, meshes):
        err.print(f"warning: {trouble}", style="yellow", markup=False, soft_wrap=True)
    out.print(f"recording: {target} (rerun {target} shows it)", markup=False, soft_wrap=True)


def _announce(address: str) -> None:
    out.print(f"view: {address} (Ctrl-C ends it)", markup=False, soft_wrap=True)
    # A process that reads a pipe waits for the address.
    out.file.flush()


def beside(place: Path, suffix: str) -> Path:
    """The page or picture of a log or a campaign where nothing else is said."""
    # "." and ".." have a name only when they are written out.
    whole = place if place.name not in ("", "..") else Path(os.path.abspath(place))
    return whole.parent / f"{whole.stem if whole.suffix == '.mcap' else whole.name}{suffix}"
