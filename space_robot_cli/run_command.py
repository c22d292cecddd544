"""`space-robot run`."""

from __future__ import annotations

import json
import signal
import traceback
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from space_robot_cli.app import (
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
from space_robot_cli.completion import choices, shipped_names
from space_robot_cli.live import FoxgloveOption, Live, check_live, folders_of, shown
from space_robot_cli.view_commands import NoBrowserOption, PortOption, show_log
from space_robot_msgs_py.errors import SpecError

if TYPE_CHECKING:
    from space_robot_bringup.experiment.experiment import Experiment
    from space_robot_bringup.modes.run import RunResult
    from space_robot_control.laws.policy import LawPolicy

MODES = ("headless", "graph", "processes")


@app.command()
def run(
    experiment: Annotated[
        str | None,
        typer.Argument(
            help="shipped name such as liu2023/fig08, or YAML file", autocompletion=shipped_names("experiments")
        ),
    ] = None,
    mode: Annotated[
        str | None,
        typer.Option(
            help=f"one of: {', '.join(MODES)}; default headless, with --from graph", autocompletion=choices(MODES)
        ),
    ] = None,
    directory: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="run directory; default runs/<name>, numbered where a run is in it"),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace a run that is in the run directory")] = False,
    realtime: Annotated[
        float | None, typer.Option(help="simulated seconds per second (graph, processes); default: as fast as it goes")
    ] = None,
    failover: Annotated[
        int,
        typer.Option(
            metavar="PERIODS",
            help="with --mode processes --realtime: a second controller takes over when one was silent for so long",
        ),
    ] = 0,
    chaos: Annotated[
        int | None,
        typer.Option(
            metavar="SEED",
            help="with --mode processes --realtime: kill, stop and restart processes, as drawn from this seed",
        ),
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
    view: Annotated[
        bool,
        typer.Option("--view", help="show it in the browser: while it runs (graph, processes), then until Ctrl-C"),
    ] = False,
    port: PortOption = 8080,
    no_browser: NoBrowserOption = False,
    foxglove: FoxgloveOption = None,
) -> None:
    """Run an experiment, log it to a bag and print the verdict."""
    began = monotonic()
    mode = mode or ("headless" if campaign_directory is None else "graph")
    if timeout is not None and not 0.0 < timeout < float("inf"):
        raise SpecError("not a limit", key="--timeout", value=timeout, accepted="a positive number of seconds")
    from space_robot_bringup.modes.run import check_pace, check_processes
    from space_robot_cli.junit import check_junit, write_junit
    from space_robot_cli.render.suites import run_suite
    from space_robot_studies.campaign.rerun import differences

    check_pace(mode, realtime)
    check_processes(mode, realtime, failover, chaos)
    check_live(mode, foxglove)
    check_junit(junit)
    if campaign_directory is not None and index is not None and not (experiment or set_ or fault or duration):
        spec, name, policy = _case(campaign_directory, index, law or (), allow_code=allow_code)
    elif law or allow_code:
        accepted = "with --from; of your own experiment: --set controller.law=FILE:Class"
        raise SpecError("is for --from", key="--law, --allow-code", accepted=accepted)
    elif experiment is not None and campaign_directory is None and index is None:
        spec, name, policy = _experiment(experiment, set_ or (), duration, fault or ())
    else:
        raise SpecError("give either EXPERIMENT or --from DIR --index K, not both", key="run")
    place = _place(name, directory, overwrite=overwrite)
    own = campaign_directory is None
    live = Live(name, port if view else None, foxglove, own=own, open_browser=view and not no_browser)
    pace: dict[str, Any] = {"realtime": realtime, "failover": failover, "chaos": chaos}
    result = _run(spec, place, mode, pace, policy, live, timeout=timeout, debug=debug, quiet=as_json)
    write_junit(junit, [run_suite(name, spec, mode, result)] if junit is not None else ())
    # A paced run may miss commands, which no row of a campaign does.
    found = None if campaign_directory is None or realtime else differences(campaign_directory, index or 0, result)
    _say(spec, mode, result, found, monotonic() - began, as_json=as_json)
    if view:
        # A browser that followed the run is open, and finds the log at the same place.
        _show(spec, result, own=own, port=port, open_browser=not no_browser and mode == "headless")
    if found or result.passed is False:
        raise typer.Exit(FAILED)


def _case(directory: Path, index: int, laws: Sequence[str], *, allow_code: bool) -> tuple[Experiment, str, LawPolicy]:
    """A case of a campaign, its name, and whose code may be its laws."""
    from space_robot_bringup.logs.logged import law_policy, with_laws
    from space_robot_studies.campaign.rerun import case_experiment

    spec = case_experiment(directory, index, allow_code=allow_code)
    policy = law_policy(laws, spec.controller.laws_by_name, allow_code=allow_code)
    return with_laws(spec, policy), f"{directory.resolve().name}_{index:06d}", policy


def _experiment(
    typed: str, overrides: Sequence[str], duration: float | None, faults: Sequence[str]
) -> tuple[Experiment, str, LawPolicy]:
    """What was typed, the name of its run, and the policy: it may name any law."""
    from space_robot_bringup.experiment.experiment import load_experiment, run_name, with_duration, with_faults
    from space_robot_control.laws.policy import TYPED

    spec = with_faults(with_duration(load_experiment(typed, overrides), duration), faults)
    return spec, run_name(typed), TYPED


def _place(name: str, directory: Path | None, *, overwrite: bool) -> Path:
    from space_robot_msgs_py.log.free_directory import checked_directory, free_directory

    if directory is None:
        return free_directory(Path("runs") / name, overwrite=overwrite)
    return checked_directory(directory, overwrite=overwrite)


def _say(
    spec: Experiment, mode: str, result: RunResult, found: list[str] | None, whole_time: float, *, as_json: bool
) -> None:
    """The verdict, and of a case of a campaign what is not as there."""
    from space_robot_cli.render import run as render

    if as_json:
        again: dict[str, object] = {"whole_time": whole_time} | ({} if found is None else {"differences": found})
        print(json.dumps(render.as_dict(spec, mode, result) | again, allow_nan=False))
        return
    render.verdict(out, spec, mode, result, whole_time)
    if found is not None:
        said = f"not as in the campaign: {'; '.join(found)}" if found else "every number is the campaign's"
        out.print(said, style="red" if found else "green", markup=False, soft_wrap=True)


def _show(spec: Experiment, result: RunResult, *, own: bool, port: int, open_browser: bool) -> None:
    from space_robot_description.load import load_robot

    folders = folders_of(load_robot(spec.robot).urdf, own=own)
    show_log(result.directory, port=port, open_browser=open_browser, meshes=folders)


def _run(
    spec: Experiment,
    place: Path,
    mode: Any,
    pace: dict[str, Any],
    policy: LawPolicy,
    live: Live,
    *,
    timeout: float | None,
    debug: bool,
    quiet: bool,
) -> RunResult:
    from space_robot_bringup.compose.composition import compose
    from space_robot_bringup.modes.compilation import notice
    from space_robot_bringup.modes.hooks import Hooks
    from space_robot_bringup.modes.run import run_composition
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
        composition = compose(spec, policy)
        with shown(composition, mode, live):
            return run_composition(composition, place, mode=mode, hooks=hooks, **pace)


def _show_trace(error: BaseException) -> None:
    err.print("".join(traceback.format_exception(error)), markup=False, soft_wrap=True)
