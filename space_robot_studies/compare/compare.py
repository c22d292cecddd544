"""Laws compared: the campaigns checked and run, their rows side by side, what a cycle costs, numbers on disk."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.judge.verdict import check_bounds
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.campaign import TABLE, CampaignResult, CheckedCampaign
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.directory import check_directory
from space_robot_studies.campaign.run_case import warm
from space_robot_studies.campaign.spec import Campaign, campaign_path, load_campaign
from space_robot_studies.compare.comparison import Comparison, law_key, side_by_side
from space_robot_studies.compare.cost import costs_of
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.engine.storage import check_place, guarded
from space_robot_studies.engine.tasks import TIME_LIMIT
from space_robot_studies.engine.workers import check_workers, open_workers

NUMBERS = "compare.json"
Costs = dict[str, dict[str, float | None]]


@dataclass(frozen=True, slots=True)
class ComparisonResult:
    """What a comparison came to.

    Attributes:
        directory: a folder per campaign, and the numbers.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        comparisons: one per campaign; empty unless completed.
        costs: campaign to law to the cost of a cycle on this machine [us].
        passed: all was run and every bound of the campaigns holds; a law that fails is a row, not a failure.
    """

    directory: Path
    end_reason: str
    comparisons: tuple[Comparison, ...] = ()
    costs: Costs | None = None
    passed: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Plain data; nothing in it depends on the machine."""
        return {"comparisons": [comparison.to_dict() for comparison in self.comparisons]}


def compare(
    campaigns: Sequence[str | Path],
    directory: str | Path,
    *,
    runs: int | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> ComparisonResult:
    """Run campaigns into a directory and put their laws side by side; options as of ``space_robot.compare``.

    Raises:
        SpaceRobotError: something is wrong with the input; nothing was written.
    """
    hooks, place = hooks or StudyHooks(), Path(directory)
    check_workers(workers, None, time_limit)
    check_place(place, "a new or empty directory, or one to resume")
    found = load_compared(campaigns, runs)
    for name, campaign in found.items():
        check_directory(place / name, campaign, resume=resume)
    checked = {
        name: CheckedCampaign.of(campaign, place / name, resume=resume, stop=hooks.stop)
        for name, campaign in found.items()
    }
    comparisons, costs, passed = [], Costs(), True
    first = (warm, (make_case(next(iter(found.values())), 0).data,))
    with open_workers(workers, time_limit=time_limit, warm=first, stop=hooks.stop) as pool:
        for name, one in checked.items():
            result = one.run(pool, "none", time_limit, hooks)
            if result.end_reason != "completed":
                return ComparisonResult(place, result.end_reason)
            passed = passed and _bounds_hold(one.campaign, result)
            comparisons.append(side_by_side(one.campaign, name, _rows(result)))
            costs[name] = costs_of(one.campaign, name, pool, hooks.stop)
    if (reason := hooks.stop()) is not None:
        return ComparisonResult(place, reason)
    made = ComparisonResult(place, "completed", tuple(comparisons), costs, passed)
    with guarded(place):
        write_atomically(place / NUMBERS, json.dumps(made.to_dict(), indent=1, allow_nan=False) + "\n")
    return made


def load_compared(campaigns: Sequence[str | Path], runs: int | None = None) -> dict[str, Campaign]:
    """The campaigns of a comparison by name.

    Raises:
        SpaceRobotError: a campaign cannot be read, compares no laws, or two have the same name.
    """
    found: dict[str, Campaign] = {}
    for argument in campaigns:
        name, campaign = campaign_path(argument).stem, load_campaign(argument, runs)
        if name in found:
            raise SpecError("compared twice", key="FILE", value=str(argument), accepted="campaigns of different names")
        law_key(campaign, name)
        found[name] = campaign
    if not found:
        raise SpecError("nothing to compare", key="FILE", accepted="campaigns that vary the law")
    return found


def _rows(result: CampaignResult) -> list[dict[str, Any]]:
    # Only here: Arrow starts threads.
    import pyarrow.parquet as pq

    rows: list[dict[str, Any]] = pq.read_table(result.directory / TABLE).to_pylist()
    return rows


def _bounds_hold(campaign: Campaign, result: CampaignResult) -> bool:
    return all(
        check.passed
        for group in result.groups
        for name, wanted in campaign.expect.items()
        for check in check_bounds(name, group.flat().get(name), wanted)
    )
