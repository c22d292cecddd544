"""What ``space-robot reproduce`` does, step by step, between its options and its exit code."""

from __future__ import annotations

import json
import signal
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from space_robot_bringup.compiling import notice
from space_robot_bringup.progress import Progress
from space_robot_bringup.reproduce.plan import choose_figures, load_plan
from space_robot_bringup.reproduce.reproduction import FlownFigure, prepare, reproduce
from space_robot_bringup.reproduce.show import show
from space_robot_bringup.reproduce.workers import cores
from space_robot_bringup.stopping import StopFlag
from space_robot_msgs_py.errors import SpecError

MOST_WORKERS = 256


def run_command(
    paper: str,
    chosen: Sequence[str],
    out: Path | None,
    workers: int | None,
    *,
    as_json: bool,
    console: Console,
    err: Console,
) -> bool:
    """Check, fly, draw, judge and print.

    Args:
        paper: name or manifest file.
        chosen: figures; none: all.
        out: directory of the report; None: ``out/<paper>``.
        workers: processes; None: one per core.
        as_json: print claims.json and nothing else on stdout.
        console: stdout.
        err: stderr, for progress.

    Returns:
        Whether everything is as documented; False if it was interrupted.

    Raises:
        SpaceRobotError: something is wrong with the input; nothing was written.
    """
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise SpecError("not a usable number", key="--workers", value=workers, accepted=f"1 to {MOST_WORKERS}")
    try:
        from space_robot_bringup.report.paper_figure import check_colors
        from space_robot_bringup.report.paper_report import PAGE, write_report
    except ImportError as error:
        raise SpecError(
            f"reproduce needs matplotlib and jinja2 ({error})", accepted="install space-robot[viz]"
        ) from None
    plan = load_plan(paper)
    figures = choose_figures(plan.manifest, chosen)
    for name in figures:
        check_colors(plan.manifest.figures[name], f"{plan.name} figures.{name}")
    laws = [flight.experiment.controller.law for flight in plan.flights(figures).values()]
    if not as_json and (line := notice(laws)):
        err.print(line)
    directory = out or Path("out") / plan.name
    prepare(plan, figures, directory)
    flights = len(plan.flights(figures))
    flown: list[FlownFigure] | None
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        with Progress(err, flights, quiet=as_json, unit="run") as progress:
            count = workers or cores()
            flown = reproduce(plan, figures, directory, workers=count, on_done=progress.reach, stop=lambda: stop.reason)
        if flown is None:
            err.print(
                f"{stop.reason}: nothing was judged; finished bags are in {directory}", markup=False, soft_wrap=True
            )
            return False
        data = write_report(plan, flown, directory)
    if as_json:
        print(json.dumps(data, allow_nan=False))
    else:
        show(console, data)
        console.print(f"page: {directory / PAGE}", markup=False, soft_wrap=True)
    return bool(data["passed"])
