"""The page of a campaign: rates with their intervals, spreads, worst cases and how to run each of them again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from space_robot_bringup.judge.conclusion import conclusion, passed
from space_robot_bringup.judge.verdict import PLANT_BOUNDS
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import LogError
from space_robot_report.pages.interactive import PlotBook, embedded, interactive_page
from space_robot_report.pages.spreads import spread_figures
from space_robot_studies.campaign.campaign import describe, judge_groups
from space_robot_studies.campaign.directory import begun_campaign, campaign_rows
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.campaign.statistics import Group, summarise
from space_robot_studies.campaign.table import FIXED
from space_robot_studies.engine.journal import bag_path

TEMPLATE = "campaign.html.j2"
# Of cases in a list; the rest is in the table of the campaign.
MAX_LISTED = 100
Columns = Mapping[str, Any]


def write_campaign_report(directory: Path, out: Path) -> int:
    """Write the page of a campaign, finished or not.

    Args:
        directory: of the campaign.
        out: the page.

    Returns:
        How many cases are on it.

    Raises:
        InputFileError: there is no campaign.
        LogError: it has no finished case, its rows are damaged, or the page cannot be written.
    """
    campaign = begun_campaign(directory)
    versions, found = campaign_rows(directory)
    rows = [found[index].columns for index in sorted(found, key=int)]
    if not rows:
        raise LogError("no case has finished yet", key=str(directory))
    write_atomically(out, campaign_page(campaign, rows, versions, directory))
    return len(rows)


def campaign_page(campaign: Campaign, rows: Sequence[Columns], versions: Mapping[str, str], directory: Path) -> str:
    """The page as HTML.

    Args:
        campaign: resolved.
        rows: of the finished cases, in order.
        versions: of everything that can change a run.
        directory: for the commands that run a case again.
    """
    book = PlotBook()
    points: dict[int, list[Columns]] = {}
    for row in rows:
        points.setdefault(row["index"] % campaign.points, []).append(row)
    labels = {at: campaign.point(at).labels for at in sorted(points)}
    groups = [summarise(points[at], labels[at], metrics_of(points[at])) for at in labels]
    named = {describe(labels[at]) or "all runs": points[at] for at in labels}
    checks = judge_groups(campaign, groups)
    content = {
        "title": campaign.title or "Campaign",
        "source": campaign.source,
        "done": len(rows),
        "total": campaign.cases,
        "conclusion": conclusion(checks),
        "passed": passed(checks),
        "checks": checks,
        "groups": [_group(group) for group in groups],
        "figures": [book.add_raw(figure, title) for title, figure in spread_figures(named).items()],
        "worst": _worst(groups, directory),
        "failures": _failures(rows, directory),
        "failed": sum(row["passed"] is False for row in rows),
        "dispersed": {key: draw.model_dump(exclude_none=True) for key, draw in campaign.disperse.items()},
        "versions": versions,
        "marks": embedded([]),
        "bands": embedded([]),
        "campaign": {"seed": campaign.seed, "runs per point": campaign.runs, "points": campaign.points},
    }
    return interactive_page(TEMPLATE, book, content)


def metrics_of(rows: Sequence[Columns]) -> list[str]:
    """Names of the numbers of runs: what stands behind the fixed columns, in order."""
    names: dict[str, None] = {}
    for row in rows:
        columns = list(row)
        names |= dict.fromkeys(columns[columns.index(list(FIXED)[-1]) + 1 :])
    return list(names)


def _group(group: Group) -> dict[str, Any]:
    return {
        "name": describe(group.labels),
        "success": group.success,
        "undecided": group.undecided,
        "remarks": group.remarks,
        "completed": group.completed,
        "reasons": group.reasons,
        "spreads": group.spreads,
    }


def _worst(groups: Sequence[Group], directory: Path) -> list[dict[str, Any]]:
    """Cases with the largest of some number, those that are worst most often first."""
    found: dict[int, list[str]] = {}
    for group in groups:
        for name, spread in group.spreads.items():
            # Where nothing spreads, no case is the worst.
            if name not in PLANT_BOUNDS and spread.worst is not None and spread.min != spread.max:
                found.setdefault(spread.worst, []).append(f"{name} {spread.max:.3g}")
    order = sorted(found, key=lambda index: (-len(found[index]), index))[:MAX_LISTED]
    return [{"index": index, "what": found[index], "command": _again(directory, index)} for index in order]


def _failures(rows: Sequence[Columns], directory: Path) -> list[dict[str, Any]]:
    failed = [row for row in rows if row["passed"] is False][:MAX_LISTED]
    return [
        {
            "index": row["index"],
            "reason": row["end_reason"],
            "missed": row["failed"],
            "command": _again(directory, row["index"]),
            "bag": str(bag) if (bag := bag_path(directory, row["index"])).exists() else "",
        }
        for row in failed
    ]


def _again(directory: Path, index: int) -> str:
    return shlex.join(["space-robot", "run", "--from", str(directory), "--index", str(index)])
