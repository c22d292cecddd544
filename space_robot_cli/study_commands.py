"""The commands that fly many runs: campaigns, comparisons and reproductions of papers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from space_robot_cli.app import FAILED, JsonOption, app, err, out, warn
from space_robot_msgs_py.errors import SpecError

if TYPE_CHECKING:
    from space_robot_studies.campaign.run_case import Keep

KEPT = ("failed", "all", "none")


@app.command()
def campaign(
    file: Annotated[str, typer.Argument(help="shipped name such as fig08_dispersed, or YAML file")],
    runs: Annotated[int | None, typer.Option(help="runs per point of the grid; default: what the file says")] = None,
    workers: Annotated[int | None, typer.Option(help="local worker processes; default: one per core")] = None,
    scheduler: Annotated[str | None, typer.Option(help="address of a Dask scheduler instead of local workers")] = None,
    directory: Annotated[Path | None, typer.Option("--out", help="directory; default runs/<name>")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="go on with what is in the directory")] = False,
    keep: Annotated[str, typer.Option(help=f"whose bags to keep, one of: {', '.join(KEPT)}")] = "failed",
    as_json: JsonOption = False,
) -> None:
    """Fly many runs with what strays drawn anew, and sum them up."""
    if keep not in KEPT:
        raise SpecError("no such choice", key="--keep", value=keep, accepted=", ".join(KEPT))
    try:
        from space_robot_cli import campaign as command
        from space_robot_cli.render import campaign as show
    except ImportError as error:
        raise SpecError(f"campaign needs Dask and more ({error})", accepted="install space-robot[campaign]") from None
    from space_robot_studies.campaign.spec import campaign_path, load_campaign

    spec = load_campaign(file, runs)
    place = directory or Path("runs") / campaign_path(file).stem
    result = command.fly(
        spec,
        place,
        workers=workers,
        scheduler=scheduler,
        resume=resume,
        keep=cast("Keep", keep),
        console=err,
        quiet=as_json,
        warn=warn,
    )
    if as_json:
        print(json.dumps(show.as_dict(spec.title, result), allow_nan=False))
    else:
        show.campaign(out, spec.title, result)
    if not result.passed:
        raise typer.Exit(FAILED)


@app.command("compare")
def compare_laws(
    files: Annotated[
        list[str] | None,
        typer.Argument(metavar="[FILE]...", help="campaigns that vary the law; default: compare_mini compare_servicer"),
    ] = None,
    runs: Annotated[int | None, typer.Option(help="runs per point of the grid; default: what the file says")] = None,
    workers: Annotated[int | None, typer.Option(help="local worker processes; default: one per core")] = None,
    directory: Annotated[Path, typer.Option("--out", help="directory")] = Path("out/compare"),
    resume: Annotated[bool, typer.Option("--resume", help="go on with what is in the directory")] = False,
    metric: Annotated[
        list[str] | None, typer.Option("--metric", metavar="NAME", help="print only this table; may be given often")
    ] = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write all tables")] = None,
    as_json: JsonOption = False,
) -> None:
    """Fly laws side by side on one task and print what each did at each period."""
    try:
        from space_robot_cli.compare import Order, carry_out
    except ImportError as error:
        raise SpecError(f"compare needs Dask and more ({error})", accepted="install space-robot[campaign]") from None

    campaigns = tuple(files or ("compare_mini", "compare_servicer"))
    order = Order(campaigns, directory, runs, workers, resume, tuple(metric or ()), markdown, as_json)
    if not carry_out(order, out, err, warn):
        raise typer.Exit(FAILED)


@app.command()
def reproduce(
    paper: Annotated[str, typer.Argument(help="shipped name such as liu2023, or manifest file")],
    figure: Annotated[
        list[str] | None, typer.Option("--figure", metavar="N", help="only this figure; may be given more than once")
    ] = None,
    directory: Annotated[Path | None, typer.Option("--out", help="report directory; default out/<paper>")] = None,
    workers: Annotated[int | None, typer.Option(help="processes; default: one per core")] = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write the claims as a table")] = None,
    as_json: JsonOption = False,
) -> None:
    """Fly the figures of a paper, draw them and judge its claims one by one."""
    from space_robot_cli.reproduce import Order, carry_out

    order = Order(paper, tuple(figure or ()), directory, workers, markdown, as_json)
    if not carry_out(order, out, err):
        raise typer.Exit(FAILED)
