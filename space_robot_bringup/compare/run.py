"""Comparisons from beginning to end: campaigns checked, run one after the other, their rows side by side."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from space_robot_bringup.campaign.cases import check_cases
from space_robot_bringup.campaign.files import guarded, write_whole
from space_robot_bringup.campaign.journal import check_directory
from space_robot_bringup.campaign.run import TABLE, CampaignResult
from space_robot_bringup.campaign.spec import Campaign, campaign_path, load_campaign
from space_robot_bringup.compare.comparison import Comparison, compare, law_key
from space_robot_bringup.compare.cost import costs_of
from space_robot_bringup.verdict import check_bounds
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath

NUMBERS = "compare.json"


@dataclass(frozen=True, eq=False, slots=True)
class ComparisonResult:
    """What a comparison left behind.

    Attributes:
        directory: where its campaigns, and ``compare.json``, are.
        end_reason: ``completed``, or why a campaign was not; then nothing was compared.
        comparisons: one per campaign, in order.
        costs: campaign to law to the median wall time of one update on this machine [us]; None: it has none.
        passed: everything was run and every bound of the campaigns holds. A law that fails is a row, not a failure.
    """

    directory: Path
    end_reason: str
    comparisons: tuple[Comparison, ...]
    costs: dict[str, dict[str, float | None]]
    passed: bool

    def to_dict(self) -> dict[str, Any]:
        """What is in ``compare.json``; nothing in it depends on the machine."""
        return {"comparisons": [comparison.to_dict() for comparison in self.comparisons]}


def checked_campaigns(
    files: Sequence[StrPath], directory: Path, *, runs: int | None, resume: bool
) -> dict[str, Campaign]:
    """The campaigns by name, as far checked as can be before the first is run.

    Raises:
        SpaceRobotError: one cannot be used, or the directory holds something else.
    """
    found: dict[str, Campaign] = {}
    for file in files:
        name, campaign = campaign_path(file).stem, load_campaign(file, runs)
        if name in found:
            raise SpecError("compared twice", key="FILE", value=str(file), accepted="campaigns with different names")
        law_key(campaign, name)
        check_directory(directory / name, campaign, resume=resume)
        if found:
            # The first is checked when it is run, before anything is written.
            check_cases(campaign)
        found[name] = campaign
    return found


def run_comparisons(
    campaigns: dict[str, Campaign], directory: Path, run: Callable[[Campaign, Path], CampaignResult]
) -> ComparisonResult:
    """Run every campaign in a directory of its own, put its rows side by side and write the numbers.

    Args:
        campaigns: by name, checked.
        directory: of the comparison.
        run: runs one campaign in its directory.
    """
    comparisons, costs, fine = list[Comparison](), dict[str, dict[str, float | None]](), True
    for name, campaign in campaigns.items():
        result = run(campaign, directory / name)
        if result.end_reason != "completed":
            return ComparisonResult(directory, result.end_reason, (), {}, passed=False)
        fine = fine and _bounds_hold(campaign, result)
        comparisons.append(compare(campaign, name, pq.read_table(result.directory / TABLE).to_pylist()))
        costs[name] = costs_of(campaign, name)
    done = ComparisonResult(directory, "completed", tuple(comparisons), costs, fine)
    with guarded(directory):
        write_whole(directory / NUMBERS, (json.dumps(done.to_dict(), indent=1, allow_nan=False) + "\n").encode())
    return done


def _bounds_hold(campaign: Campaign, result: CampaignResult) -> bool:
    return all(
        check.passed
        for group in result.groups
        for name, wanted in campaign.expect.items()
        for check in check_bounds(name, group.flat().get(name), wanted)
    )
