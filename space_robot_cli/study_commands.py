"""The commands of many runs: campaigns, comparisons and reproductions of papers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from space_robot_cli.app import FAILED, JsonOption, JunitOption, SetOption, app, err, out
from space_robot_cli.completion import choices, shipped_names
from space_robot_cli.study import ResumeOption, TimeLimitOption, WorkersOption, announce, single_threaded, study
from space_robot_msgs_py.errors import SpecError

if TYPE_CHECKING:
    from space_robot_studies.campaign.run_case import Keep

KEPT = ("failed", "all", "none")


@app.command()
def campaign(
    file: Annotated[
        str,
        typer.Argument(
            help="shipped name such as fig08_dispersed, or YAML file", autocompletion=shipped_names("campaigns")
        ),
    ],
    runs: Annotated[int | None, typer.Option(help="runs per point of the grid; default: what the file says")] = None,
    workers: WorkersOption = None,
    scheduler: Annotated[str | None, typer.Option(help="address of a Dask scheduler instead of local workers")] = None,
    directory: Annotated[Path | None, typer.Option("--out", "-o", help="directory; default runs/<name>")] = None,
    resume: ResumeOption = False,
    set_: SetOption = None,
    keep: Annotated[
        str, typer.Option(help=f"whose bags to keep, one of: {', '.join(KEPT)}", autocompletion=choices(KEPT))
    ] = "failed",
    time_limit: TimeLimitOption = None,
    junit: JunitOption = None,
    as_json: JsonOption = False,
) -> None:
    """Run a Monte Carlo campaign and summarise it."""
    if keep not in KEPT:
        raise SpecError("no such choice", key="--keep", value=keep, accepted=", ".join(KEPT))
    single_threaded()
    from space_robot_cli.junit import check_junit, write_junit
    from space_robot_cli.render import campaign as show
    from space_robot_cli.render.suites import campaign_suites
    from space_robot_studies.campaign.campaign import run_campaign
    from space_robot_studies.campaign.cases import make_case
    from space_robot_studies.campaign.spec import campaign_path, load_campaign
    from space_robot_studies.engine.tasks import TIME_LIMIT

    check_junit(junit)
    name = campaign_path(file).stem
    with study(err, quiet=as_json) as hooks:
        spec = load_campaign(file, runs, set_ or ())
        if not as_json:
            laws = [make_case(spec, index).data["controller"]["law"] for index in range(spec.points)]
            announce(err, laws, plant=scheduler is None)
        result = run_campaign(
            spec,
            directory or Path("runs") / name,
            workers=workers,
            scheduler=scheduler,
            resume=resume,
            keep=cast("Keep", keep),
            time_limit=TIME_LIMIT if time_limit is None else time_limit,
            hooks=hooks,
        )
    write_junit(junit, campaign_suites(name, spec, result) if junit is not None else ())
    if as_json:
        print(json.dumps(show.as_dict(spec.title, result), allow_nan=False))
    else:
        show.campaign(out, spec.title, result)
    if result.passed is False:
        raise typer.Exit(FAILED)


@app.command("compare")
def compare_laws(
    files: Annotated[
        list[str] | None,
        typer.Argument(metavar="FILE", help="campaigns that vary the law; default: compare_mini compare_servicer"),
    ] = None,
    runs: Annotated[int | None, typer.Option(help="runs per point of the grid; default: what the file says")] = None,
    workers: WorkersOption = None,
    directory: Annotated[Path, typer.Option("--out", "-o", help="directory")] = Path("out/compare"),
    resume: ResumeOption = False,
    time_limit: TimeLimitOption = None,
    metric: Annotated[
        list[str] | None, typer.Option("--metric", metavar="NAME", help="print only this table; may be given often")
    ] = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write all tables")] = None,
    as_json: JsonOption = False,
) -> None:
    """Run laws side by side on one task, at several periods."""
    single_threaded()
    from space_robot_cli.compare import Options, run
    from space_robot_cli.study_options import StudyOptions

    campaigns, metrics = tuple(files or ("compare_mini", "compare_servicer")), tuple(metric or ())
    shared = StudyOptions(workers, resume, time_limit, markdown, as_json)
    options = Options(campaigns, directory, shared, runs, metrics)
    if not run(options, out, err):
        raise typer.Exit(FAILED)


@app.command()
def tune(
    file: Annotated[str, typer.Argument(help="shipped name such as tune_short, or YAML file")],
    law: Annotated[
        list[str] | None, typer.Option("--law", metavar="NAME", help="only this law; may be given more than once")
    ] = None,
    budget: Annotated[
        int | None, typer.Option(help="evaluations per law and point of the grid; default: what the file says")
    ] = None,
    workers: WorkersOption = None,
    directory: Annotated[Path | None, typer.Option("--out", "-o", help="directory; default runs/<name>")] = None,
    resume: ResumeOption = False,
    time_limit: TimeLimitOption = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write the table")] = None,
    as_json: JsonOption = False,
) -> None:
    """Search the gains of laws, the same budget for each."""
    single_threaded()
    from space_robot_bringup.public.calls import needing

    with needing("tune", "campaign"):
        from space_robot_cli.tune import Options, run
    from space_robot_cli.study_options import StudyOptions

    shared = StudyOptions(workers, resume, time_limit, markdown, as_json)
    if not run(Options(file, shared, tuple(law or ()), budget, directory), out, err):
        raise typer.Exit(FAILED)


@app.command()
def benchmark(
    file: Annotated[
        str,
        typer.Argument(help="shipped name or YAML file", autocompletion=shipped_names("benchmarks")),
    ] = "v1",
    law: Annotated[
        list[str] | None,
        typer.Option(
            "--law", metavar="NAME", help="of the set, or module:Class, file.py:Class; may be given more than once"
        ),
    ] = None,
    task: Annotated[
        list[str] | None, typer.Option("--task", metavar="NAME", help="only this task; may be given more than once")
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only", metavar="KEY=LABEL", help="only these points of what is varied, e.g. control_period=0.5"
        ),
    ] = None,
    short: Annotated[bool, typer.Option("--short", help="the part of the set that is over in minutes")] = False,
    table: Annotated[
        Path | None, typer.Option(metavar="FILE", help="results to enter the rows in; default table.json in --out")
    ] = None,
    workers: WorkersOption = None,
    directory: Annotated[Path, typer.Option("--out", help="directory of the searches")] = Path("out/benchmark"),
    resume: ResumeOption = False,
    time_limit: TimeLimitOption = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write all tables")] = None,
    as_json: JsonOption = False,
) -> None:
    """Tune laws under equal rules and judge them in pairs."""
    single_threaded()
    from space_robot_bringup.public.calls import needing

    with needing("benchmark", "campaign"):
        from space_robot_cli.benchmark import Options, run
    from space_robot_cli.study_options import StudyOptions

    shared = StudyOptions(workers, resume, time_limit, markdown, as_json)
    laws, tasks, points = (tuple(some or ()) for some in (law, task, only))
    if not run(Options(file, directory, shared, laws, tasks, points, short, table), out, err):
        raise typer.Exit(FAILED)


@app.command()
def reproduce(
    paper: Annotated[
        str,
        typer.Argument(help="shipped name such as liu2023, or manifest file", autocompletion=shipped_names("papers")),
    ],
    figure: Annotated[
        list[str] | None, typer.Option("--figure", metavar="N", help="only this figure; may be given more than once")
    ] = None,
    directory: Annotated[Path | None, typer.Option("--out", "-o", help="report directory; default out/<paper>")] = None,
    workers: WorkersOption = None,
    resume: Annotated[bool, typer.Option("--resume", help="keep the finished runs that are still the same")] = False,
    time_limit: TimeLimitOption = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="also write the claims as a table")] = None,
    as_json: JsonOption = False,
) -> None:
    """Run the figures of a paper and judge its claims."""
    single_threaded()
    from space_robot_cli.reproduce import Options, run
    from space_robot_cli.study_options import StudyOptions

    shared = StudyOptions(workers, resume, time_limit, markdown, as_json)
    options = Options(paper, shared, tuple(figure or ()), directory)
    if not run(options, out, err):
        raise typer.Exit(FAILED)
