"""What ``space-robot reproduce`` does, step by step, between its options and its exit code."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from space_robot_bringup.compiling import notice
from space_robot_bringup.progress import Progress
from space_robot_bringup.reproduce.markdown import markdown
from space_robot_bringup.reproduce.plan import Plan, choose_figures, load_plan
from space_robot_bringup.reproduce.reproduction import FlownFigure, prepare, reproduce
from space_robot_bringup.reproduce.show import show
from space_robot_bringup.reproduce.workers import cores
from space_robot_bringup.stopping import StopFlag
from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError, SpecError

MOST_WORKERS = 256


@dataclass(frozen=True, slots=True)
class Order:
    """What was asked for.

    Attributes:
        paper: name or manifest file.
        figures: which; none: all.
        directory: of the report; None: ``out/<paper>``.
        workers: processes; None: one per core.
        markdown: where the claims go as a table; None: nowhere.
        as_json: print claims.json and nothing else on stdout.
    """

    paper: str
    figures: tuple[str, ...] = ()
    directory: Path | None = None
    workers: int | None = None
    markdown: Path | None = None
    as_json: bool = False


def carry_out(order: Order, out: Console, err: Console) -> bool:
    """Check, fly, draw, judge and print.

    Args:
        order: what to do.
        out: stdout.
        err: stderr, for progress.

    Returns:
        Whether everything is as documented; False if it was interrupted.

    Raises:
        SpaceRobotError: something is wrong with the input; nothing was written.
    """
    if order.workers is not None and not 1 <= order.workers <= MOST_WORKERS:
        raise SpecError("not a usable number", key="--workers", value=order.workers, accepted=f"1 to {MOST_WORKERS}")
    try:
        from space_robot_bringup.report.paper_figure import check_colors
        from space_robot_bringup.report.paper_report import PAGE, write_report
        from space_robot_bringup.report.whole import write_whole
    except ImportError as error:
        needs = f"reproduce needs matplotlib and jinja2 ({error})"
        raise SpecError(needs, accepted="install space-robot[viz]") from None
    plan = load_plan(order.paper)
    figures = choose_figures(plan.manifest, order.figures)
    for name in figures:
        check_colors(plan.manifest.figures[name], f"{plan.argument} figures.{name}")
    if order.markdown is not None and not is_directory(order.markdown.resolve().parent):
        raise InputFileError("no such folder", key="--markdown", value=short(order.markdown))
    directory = order.directory or Path("out") / plan.name
    flights = plan.flights(figures).values()
    laws = [name for flight in flights for name in flight.experiment.controller.law_names]
    if not order.as_json and (line := notice(laws)):
        err.print(line)
    prepare(plan, figures, directory)
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        flown = _fly(plan, figures, directory, order, err, lambda: stop.reason)
        if flown is None:
            line = f"{stop.reason}: nothing was judged; finished bags are in {directory}"
            err.print(line, markup=False, soft_wrap=True)
            return False
        data = write_report(plan, flown, directory)
        if order.markdown is not None:
            write_whole(order.markdown, markdown(data))
    if order.as_json:
        print(json.dumps(data, allow_nan=False))
    else:
        show(out, data)
        out.print(f"page: {directory / PAGE}", markup=False, soft_wrap=True)
    return bool(data["passed"])


def _fly(
    plan: Plan, figures: Sequence[str], directory: Path, order: Order, err: Console, stop: Callable[[], str | None]
) -> list[FlownFigure] | None:
    flights = len(plan.flights(figures))
    with Progress(err, flights, quiet=order.as_json, unit="run") as progress:
        workers = order.workers or cores()
        return reproduce(plan, figures, directory, workers=workers, on_done=progress.reach, stop=stop)
