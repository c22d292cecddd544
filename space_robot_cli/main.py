"""The command line: it parses, calls the library and prints; nothing else.

Imports of the library stand inside the commands: numba and Pinocchio take a second to load, and ``--help`` needs none.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import traceback
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Never

import typer

import space_robot_cli.log_commands
import space_robot_cli.study_commands  # noqa: F401  (their commands belong to the same application)
from space_robot_bringup.modes.signals import Interrupted, raising
from space_robot_cli.app import (
    BAD_INPUT,
    FAILED,
    AllowCodeOption,
    FaultOption,
    JsonOption,
    JunitOption,
    LawOption,
    SetOption,
    app,
    err,
    out,
    warn,
)
from space_robot_cli.view_commands import NoBrowserOption, PortOption, show_log
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import SpaceRobotError, SpecError

if TYPE_CHECKING:
    from space_robot_bringup.experiment.experiment import Experiment
    from space_robot_bringup.modes.run import RunResult
    from space_robot_control.laws.policy import LawPolicy

MODES = ("headless", "graph", "processes")
# What typer makes of a KeyboardInterrupt.
INTERRUPTED = 130


@app.command("list")
def list_shipped(
    kind: Annotated[
        str,
        typer.Argument(
            help="experiments, papers, campaigns, supervision, robots, laws or faults; default: all but the last two"
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
    file: Annotated[str, typer.Argument(help="experiment, campaign or paper: shipped name or YAML file")],
    set_: SetOption = None,
    fault: FaultOption = None,
    kind: Annotated[str, typer.Option(help="experiment, campaign or paper; default: what it looks like")] = "",
) -> None:
    """Check an experiment, campaign or paper without running it."""
    from space_robot_cli.check import check_file, kind_of

    checked = check_file(file, kind or kind_of(file), set_ or (), err.print, faults=fault or ())
    out.print(f"{file}: fine. {checked.summary}", markup=False, soft_wrap=True)
    for line in checked.facts:
        out.print(f"  {line}", markup=False, soft_wrap=True)
    for warning in checked.warnings:
        warn(warning)


@app.command()
def robot(
    file: Annotated[str, typer.Argument(help="shipped name or YAML file")],
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
def run(
    experiment: Annotated[str | None, typer.Argument(help="shipped name such as liu2023/fig08, or YAML file")] = None,
    mode: Annotated[
        str | None, typer.Option(help=f"one of: {', '.join(MODES)}; default headless, with --from graph")
    ] = None,
    directory: Annotated[
        Path | None, typer.Option("--out", help="run directory; default runs/<name>, numbered where a run is in it")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace a run that is in the run directory")] = False,
    realtime: Annotated[
        float | None, typer.Option(help="simulated seconds per second (graph, processes); default: as fast as it goes")
    ] = None,
    set_: SetOption = None,
    fault: FaultOption = None,
    duration: Annotated[float | None, typer.Option(help="run this long instead [s]")] = None,
    campaign_directory: Annotated[
        Path | None, typer.Option("--from", metavar="DIR", help="run one case of this campaign, with --index")
    ] = None,
    index: Annotated[int | None, typer.Option(help="of the case, with --from")] = None,
    law: LawOption = None,
    allow_code: AllowCodeOption = False,
    timeout: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            help="end with the reason timeout after so many seconds of CPU time of a process, or without a new tick",
        ),
    ] = None,
    debug: Annotated[bool, typer.Option("--debug", help="show the traceback of a law that fails")] = False,
    junit: JunitOption = None,
    as_json: JsonOption = False,
    view: Annotated[bool, typer.Option("--view", help="then show it in the browser until Ctrl-C")] = False,
    port: PortOption = 8080,
    no_browser: NoBrowserOption = False,
) -> None:
    """Run an experiment, log it to a bag and print the verdict."""
    mode = mode or ("headless" if campaign_directory is None else "graph")
    if timeout is not None and not 0.0 < timeout < float("inf"):
        raise SpecError("not a limit", key="--timeout", value=timeout, accepted="a positive number of seconds")
    from space_robot_bringup.experiment.experiment import load_experiment, run_name, with_duration, with_faults
    from space_robot_bringup.logs.logged import law_policy, with_laws
    from space_robot_bringup.modes.run import check_pace
    from space_robot_cli.junit import check_junit, write_junit
    from space_robot_cli.render import run as render
    from space_robot_cli.render.suites import run_suite
    from space_robot_control.laws.policy import TYPED
    from space_robot_msgs_py.log.free_directory import checked_directory, free_directory
    from space_robot_studies.campaign.rerun import case_experiment, differences

    check_pace(mode, realtime)
    check_junit(junit)
    policy = TYPED
    if campaign_directory is not None and index is not None and not (experiment or set_ or fault or duration):
        spec = case_experiment(campaign_directory, index, allow_code=allow_code)
        policy = law_policy(law or (), spec.controller.laws_by_name, allow_code=allow_code)
        spec, name = with_laws(spec, policy), f"{campaign_directory.resolve().name}_{index:06d}"
    elif law or allow_code:
        accepted = "with --from; of your own experiment: --set controller.law=FILE:Class"
        raise SpecError("is for --from", key="--law, --allow-code", accepted=accepted)
    elif experiment is not None and campaign_directory is None and index is None:
        spec = with_faults(with_duration(load_experiment(experiment, set_ or ()), duration), fault or ())
        name = run_name(experiment)
    else:
        raise SpecError("give either EXPERIMENT or --from DIR --index K, not both", key="run")
    place = (
        free_directory(Path("runs") / name, overwrite=overwrite)
        if directory is None
        else checked_directory(directory, overwrite=overwrite)
    )
    result = _run(spec, place, mode, realtime, policy, timeout=timeout, debug=debug, quiet=as_json)
    write_junit(junit, [run_suite(name, spec, mode, result)] if junit is not None else ())
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
    if view:
        from space_robot_description.load import load_robot
        from space_robot_description.share import mesh_folders

        # The user has just run this robot; one out of a campaign directory shows what any log may.
        folders = mesh_folders(load_robot(spec.robot).urdf) if campaign_directory is None else ()
        show_log(result.directory, port=port, open_browser=not no_browser, meshes=folders)
    if found or result.passed is False:
        raise typer.Exit(FAILED)


@app.command()
def schema(
    kind: Annotated[str, typer.Argument(help="experiment, campaign or paper")] = "experiment",
) -> None:
    """Print the JSON schema of a kind of file, for editors."""
    from space_robot_cli.check import schema_of

    print(json.dumps(schema_of(kind), indent=2))


@app.command()
def new(
    kind: Annotated[str, typer.Argument(help="experiment, law, robot or study")],
    name: Annotated[Path, typer.Argument(help="of the file, e.g. my_law")],
) -> None:
    """Write a working, commented start for a file of your own."""
    from space_robot_cli.new import write_new

    for path in write_new(kind, name):
        out.print(f"written: {path}", markup=False, soft_wrap=True)


def _run(
    spec: Experiment,
    place: Path,
    mode: Any,
    realtime: float | None,
    policy: LawPolicy,
    *,
    timeout: float | None,
    debug: bool,
    quiet: bool,
) -> RunResult:
    from space_robot_bringup.modes.compilation import notice
    from space_robot_bringup.modes.hooks import Hooks
    from space_robot_bringup.modes.run import run_experiment
    from space_robot_bringup.modes.signals import RunStop
    from space_robot_cli.progress import Progress

    if not quiet and (line := notice(spec.controller.law_names, policy=policy)):
        err.print(line)
    with (
        RunStop(signal.SIGINT, signal.SIGTERM, timeout=timeout) as stop,
        Progress(err, spec.steps, quiet=quiet) as progress,
    ):

        def on_tick(tick: int) -> None:
            stop.reach(tick)
            progress.reach(tick)

        hooks = Hooks(on_tick, stop=lambda: stop.reason, warn=warn, on_end=lambda reason: stop.lift())
        if debug:
            hooks = replace(hooks, on_failure=_show_trace, debug=True)
        return run_experiment(spec, place, mode=mode, realtime=realtime, hooks=hooks, policy=policy)


def _show_trace(error: BaseException) -> None:
    err.print("".join(traceback.format_exception(error)), markup=False, soft_wrap=True)


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
