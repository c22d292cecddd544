"""What ``space-robot compare`` does, step by step, between its options and its exit code."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from space_robot_cli import campaign as command
from space_robot_cli.render.comparison import show
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError, SpecError
from space_robot_studies.campaign.campaign import CampaignResult
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.campaign.storage import guarded
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.compare.run import ComparisonResult, checked_campaigns, run_comparisons
from space_robot_studies.compare.tables import markdown


@dataclass(frozen=True, slots=True)
class Order:
    """What was asked for.

    Attributes:
        campaigns: names or files.
        directory: of the comparison.
        runs: per point of the grid; None: what the files say.
        workers: processes; None: one per core.
        resume: go on with what is in the directory.
        metrics: which tables are printed; none: all.
        markdown: where all tables go; None: nowhere.
        as_json: print numbers and nothing else on stdout.
    """

    campaigns: tuple[str, ...]
    directory: Path
    runs: int | None = None
    workers: int | None = None
    resume: bool = False
    metrics: tuple[str, ...] = ()
    markdown: Path | None = None
    as_json: bool = False


def carry_out(order: Order, out: Console, err: Console, warn: Callable[[str], None]) -> bool:
    """Check, fly, put side by side, draw and print.

    Args:
        order: what to do.
        out: stdout.
        err: stderr, for progress.
        warn: told what the laws warn of.

    Returns:
        Whether all was flown and every bound of the campaigns holds. A law that fails is a row, not a failure.

    Raises:
        SpaceRobotError: something is wrong with the input.
    """
    _check_output(order)
    campaigns = checked_campaigns(order.campaigns, order.directory, runs=order.runs, resume=order.resume)
    result = run_comparisons(
        campaigns, order.directory, lambda campaign, place: _fly(order, campaign, place, err, warn)
    )
    if result.end_reason != "completed":
        err.print(f"{result.end_reason}: nothing was compared; go on with --resume", markup=False)
        return False
    _write(order, result)
    if order.as_json:
        print(json.dumps(result.to_dict() | {"costs_us": result.costs}, allow_nan=False))
        return result.passed
    for comparison in result.comparisons:
        show(out, comparison, result.costs[comparison.name], order.metrics or tuple(METRICS))
    out.print(f"numbers and pictures: {order.directory}", markup=False, soft_wrap=True)
    return result.passed


def _check_output(order: Order) -> None:
    for metric in order.metrics:
        if metric not in METRICS:
            raise SpecError("no such metric", key="--metric", value=metric, accepted=", ".join(METRICS))
    if order.markdown is not None and not is_directory(order.markdown.resolve().parent):
        raise InputFileError("no such folder", key="--markdown", value=short(order.markdown))


def _fly(order: Order, campaign: Campaign, place: Path, err: Console, warn: Callable[[str], None]) -> CampaignResult:
    return command.fly(
        campaign,
        place,
        workers=order.workers,
        scheduler=None,
        resume=order.resume and is_directory(place),
        keep="none",
        console=err,
        quiet=order.as_json,
        warn=warn,
    )


def _write(order: Order, result: ComparisonResult) -> None:
    """Pictures where matplotlib is, and the tables where they were asked for."""
    if order.markdown is not None:
        with guarded(order.markdown):
            write_atomically(order.markdown, markdown(result.comparisons, result.costs).encode())
    try:
        from space_robot_report.figures.comparison import draw_comparison
    except ImportError:
        return
    for comparison in result.comparisons:
        draw_comparison(comparison, order.directory / f"{comparison.name}.png")
