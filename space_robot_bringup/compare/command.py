"""What ``space-robot compare`` does, step by step, between its options and its exit code."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
from rich.console import Console

from space_robot_bringup.campaign import command
from space_robot_bringup.campaign.cases import check_cases
from space_robot_bringup.campaign.files import guarded, write_whole
from space_robot_bringup.campaign.journal import check_directory
from space_robot_bringup.campaign.run import TABLE, CampaignResult
from space_robot_bringup.campaign.spec import Campaign, campaign_path, load_campaign
from space_robot_bringup.compare.comparison import METRICS, Comparison, compare, law_key
from space_robot_bringup.compare.cost import costs_of
from space_robot_bringup.compare.show import show
from space_robot_bringup.compare.tables import markdown
from space_robot_bringup.verdict import check_bounds
from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError, SpecError

NUMBERS = "compare.json"


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
    campaigns = _checked(order)
    comparisons, costs, fine = [], {}, True
    for name, campaign in campaigns.items():
        result = _fly(order, name, campaign, err, warn)
        if result.end_reason != "completed":
            err.print(f"{result.end_reason}: nothing was compared; go on with --resume", markup=False)
            return False
        fine = fine and _bounds_hold(campaign, result)
        comparisons.append(compare(campaign, name, pq.read_table(result.directory / TABLE).to_pylist()))
        costs[name] = costs_of(campaign, name)
    _write(order, comparisons, costs)
    if order.as_json:
        print(json.dumps(_data(comparisons) | {"costs_us": costs}, allow_nan=False))
        return fine
    for comparison in comparisons:
        show(out, comparison, costs[comparison.name], order.metrics or tuple(METRICS))
    out.print(f"numbers and pictures: {order.directory}", markup=False, soft_wrap=True)
    return fine


def _checked(order: Order) -> dict[str, Campaign]:
    """The campaigns by name, as far checked as can be before the first is flown."""
    for metric in order.metrics:
        if metric not in METRICS:
            raise SpecError("no such metric", key="--metric", value=metric, accepted=", ".join(METRICS))
    if order.markdown is not None and not is_directory(order.markdown.resolve().parent):
        raise InputFileError("no such folder", key="--markdown", value=short(order.markdown))
    found: dict[str, Campaign] = {}
    for argument in order.campaigns:
        name, campaign = campaign_path(argument).stem, load_campaign(argument, order.runs)
        if name in found:
            raise SpecError("compared twice", key="FILE", value=argument, accepted="campaigns with different names")
        law_key(campaign, name)
        check_directory(order.directory / name, campaign, resume=order.resume)
        if found:
            # The first is checked when it is flown, before anything is written.
            check_cases(campaign)
        found[name] = campaign
    return found


def _fly(order: Order, name: str, campaign: Campaign, err: Console, warn: Callable[[str], None]) -> CampaignResult:
    return command.fly(
        campaign,
        order.directory / name,
        workers=order.workers,
        scheduler=None,
        resume=order.resume and is_directory(order.directory / name),
        keep="none",
        console=err,
        quiet=order.as_json,
        warn=warn,
    )


def _bounds_hold(campaign: Campaign, result: CampaignResult) -> bool:
    return all(
        check.passed
        for group in result.groups
        for name, wanted in campaign.expect.items()
        for check in check_bounds(name, group.flat().get(name), wanted)
    )


def _data(comparisons: Sequence[Comparison]) -> dict[str, Any]:
    return {"comparisons": [comparison.to_dict() for comparison in comparisons]}


def _write(order: Order, comparisons: Sequence[Comparison], costs: dict[str, dict[str, float | None]]) -> None:
    """Numbers, pictures where matplotlib is, and the tables where they were asked for."""
    with guarded(order.directory):
        content = json.dumps(_data(comparisons), indent=1, allow_nan=False) + "\n"
        write_whole(order.directory / NUMBERS, content.encode())
        if order.markdown is not None:
            write_whole(order.markdown, markdown(comparisons, costs).encode())
    try:
        from space_robot_bringup.report.compare_chart import draw_comparison
    except ImportError:
        return
    for comparison in comparisons:
        draw_comparison(comparison, order.directory / f"{comparison.name}.png")
