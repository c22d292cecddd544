"""The command line: it parses, calls the library and prints; nothing else.

Imports of the library stand inside the commands: numba and Pinocchio take a second to load, and ``--help`` needs none.
"""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Never, cast

import typer
from rich.console import Console

from space_robot_msgs_py.errors import SpaceRobotError, SpecError

if TYPE_CHECKING:
    from space_robot_bringup.campaign.fly import Keep
    from space_robot_bringup.experiment import Experiment
    from space_robot_bringup.run import RunResult

FAILED, BAD_INPUT = 1, 2
MODES = ("headless", "graph", "processes")
KEPT = ("failed", "all", "none")

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Flight software of a space robot, emulated: fly experiments, record them, look at robots.",
    epilog="Exit codes: 0 fine, 1 the run failed its verdict, 2 bad input or usage.",
)
# A pipe has no width of its own; 80 columns would cut numbers.
out = Console(highlight=False, width=None if sys.stdout.isatty() else 120)
err = Console(stderr=True, highlight=False)

ExperimentArgument = Annotated[str, typer.Argument(help="shipped name such as liu2023/fig08, or YAML file")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="override one key, e.g. controller.gains.damping=0.7"),
]
JsonOption = Annotated[bool, typer.Option("--json", help="print one JSON object on stdout and nothing else there")]


@app.command("list")
def list_shipped() -> None:
    """List the shipped experiments, papers, campaigns and robots."""
    from space_robot_bringup.catalogue import catalogue

    for kind, rows in catalogue().items():
        out.print(kind, style="bold")
        for name, title in rows.items():
            out.print(f"  {name:<34}{title}", markup=False, soft_wrap=True)


@app.command()
def check(experiment: ExperimentArgument, set_: SetOption = None) -> None:
    """Check an experiment completely without flying it."""
    from space_robot_bringup.compiling import notice
    from space_robot_bringup.compose import compose
    from space_robot_bringup.experiment import load_experiment

    spec = load_experiment(experiment, set_ or ())
    if line := notice([spec.controller.law], plant=False):
        err.print(line)
    composition = compose(spec)
    nominal, review = composition.nominal, composition.review()
    out.print(
        f"{experiment}: fine. {nominal.name}, {nominal.n} joints, {spec.controller.law}, "
        f"{spec.steps} periods of {spec.control_period:g} s",
        markup=False,
        soft_wrap=True,
    )
    for line in review.facts:
        out.print(f"  {line}", markup=False, soft_wrap=True)
    for warning in review.warnings:
        _warn(warning)


@app.command()
def robot(
    file: Annotated[str, typer.Argument(help="shipped name or YAML file")],
    as_json: JsonOption = False,
) -> None:
    """Print mass, inertia, momentum capacity, reach and the condition of the base-arm coupling of a robot."""
    from space_robot_bringup import render
    from space_robot_description.load import load_robot
    from space_robot_description.report import robot_report

    report = robot_report(load_robot(file))
    if as_json:
        print(json.dumps(report.to_dict(), allow_nan=False))
    else:
        render.robot(out, report)


@app.command()
def run(
    experiment: Annotated[str | None, typer.Argument(help="shipped name such as liu2023/fig08, or YAML file")] = None,
    mode: Annotated[
        str | None, typer.Option(help=f"one of: {', '.join(MODES)}; default headless, with --from graph")
    ] = None,
    directory: Annotated[Path | None, typer.Option("--out", help="run directory; default runs/<name>")] = None,
    realtime: Annotated[
        float | None, typer.Option(help="simulated seconds per second (graph, processes); default: as fast as it goes")
    ] = None,
    set_: SetOption = None,
    duration: Annotated[float | None, typer.Option(help="fly this long instead [s]")] = None,
    campaign_directory: Annotated[
        Path | None, typer.Option("--from", metavar="DIR", help="fly one case of this campaign, with --index")
    ] = None,
    index: Annotated[int | None, typer.Option(help="of the case, with --from")] = None,
    as_json: JsonOption = False,
) -> None:
    """Fly an experiment, log it to a bag and print the verdict."""
    mode = mode or ("headless" if campaign_directory is None else "graph")
    if mode not in MODES:
        raise SpecError("no such mode", key="--mode", value=mode, accepted=", ".join(MODES))
    if realtime is not None and not 1e-3 <= realtime <= 1e4:
        raise SpecError("not a usable factor", key="--realtime", value=realtime, accepted="0.001 to 10000")
    from space_robot_bringup import render
    from space_robot_bringup.campaign.again import case_experiment, differences
    from space_robot_bringup.experiment import experiment_path, load_experiment, with_duration

    if campaign_directory is not None and index is not None and not (experiment or set_ or duration):
        spec, name = case_experiment(campaign_directory, index), f"{campaign_directory.resolve().name}_{index:06d}"
    elif experiment is not None and campaign_directory is None and index is None:
        spec = with_duration(load_experiment(experiment, set_ or ()), duration)
        name = experiment_path(experiment).stem
    else:
        accepted = "an experiment with --set and --duration, or --from DIR with --index K"
        raise SpecError("says not what to fly, or twice", key="run", accepted=accepted)
    result = _fly(spec, directory or Path("runs") / name, mode, realtime, quiet=as_json)
    # A paced run may miss commands, which no row of a campaign does.
    found = None if campaign_directory is None or realtime else differences(campaign_directory, index or 0, result)
    if as_json:
        again = {} if campaign_directory is None else {"differences": found}
        print(json.dumps(render.as_dict(spec, mode, result) | again, allow_nan=False))
    else:
        render.verdict(out, spec, mode, result)
        if found is not None:
            said = f"not as in the campaign: {'; '.join(found)}" if found else "every number is the campaign's"
            out.print(said, style="red" if found else "green", markup=False, soft_wrap=True)
    if found or not result.passed:
        raise typer.Exit(FAILED)


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
        from space_robot_bringup.campaign import command, show
    except ImportError as error:
        raise SpecError(f"campaign needs Dask and more ({error})", accepted="install space-robot[campaign]") from None
    from space_robot_bringup.campaign.spec import campaign_path, load_campaign

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
        warn=_warn,
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
        from space_robot_bringup.compare.command import Order, carry_out
    except ImportError as error:
        raise SpecError(f"compare needs Dask and more ({error})", accepted="install space-robot[campaign]") from None

    campaigns = tuple(files or ("compare_mini", "compare_servicer"))
    order = Order(campaigns, directory, runs, workers, resume, tuple(metric or ()), markdown, as_json)
    if not carry_out(order, out, err, _warn):
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
    from space_robot_bringup.reproduce.command import Order, carry_out

    order = Order(paper, tuple(figure or ()), directory, workers, markdown, as_json)
    if not carry_out(order, out, err):
        raise typer.Exit(FAILED)


@app.command()
def plot(
    log: Annotated[Path, typer.Argument(help="run directory or .mcap file")],
    picture: Annotated[Path | None, typer.Option("--out", help="image file; default LOG.png")] = None,
) -> None:
    """Draw a log: attitude and joints against what was asked, and the torques it took."""
    try:
        from space_robot_bringup.report.figure import draw
    except ImportError as error:
        raise SpecError(f"plot needs matplotlib ({error})", accepted="install space-robot[viz]") from None
    place = picture or log.with_suffix(".png")
    draw(log, place)
    out.print(f"picture: {place}", markup=False, soft_wrap=True)


@app.command()
def schema() -> None:
    """Print the JSON schema of experiment files, for editors."""
    from space_robot_bringup.experiment import Experiment

    print(json.dumps(Experiment.model_json_schema(), indent=2))


def _warn(warning: str) -> None:
    err.print(f"warning: {warning}", style="yellow", markup=False, soft_wrap=True)


def _fly(spec: Experiment, place: Path, mode: Any, realtime: float | None, *, quiet: bool) -> RunResult:
    from space_robot_bringup.compiling import notice
    from space_robot_bringup.progress import Progress
    from space_robot_bringup.run import Hooks, run_experiment
    from space_robot_bringup.stopping import StopFlag

    if not quiet and (line := notice([spec.controller.law])):
        err.print(line)
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop, Progress(err, spec.steps, quiet=quiet) as progress:
        hooks = Hooks(on_tick=progress.reach, stop=lambda: stop.reason, warn=_warn)
        return run_experiment(spec, place, mode=mode, realtime=realtime, hooks=hooks)


def main() -> Never:
    """Entry point: one line per error, exit 2 on bad input, no traceback."""
    try:
        # Without standalone mode an Exit of a command is what app returns.
        code = app(standalone_mode=False)
    except SpaceRobotError as error:
        err.print(f"space-robot: {error}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(FAILED)
    except Exception as error:
        # Usage errors of the parser know how to show themselves; anything else is a bug and shows its trace.
        show = getattr(error, "format_message", None)
        if show is None:
            raise
        err.print(f"space-robot: {show()}; see --help", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    sys.exit(code or 0)
