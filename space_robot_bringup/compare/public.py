"""`space_robot.compare`: laws side by side on the same tasks."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from space_robot_bringup.public.calls import for_python, needing
from space_robot_msgs_py.paths import StrPath

if TYPE_CHECKING:
    from space_robot_bringup.campaign.run import CampaignHooks, CampaignResult
    from space_robot_bringup.campaign.spec import Campaign
    from space_robot_bringup.compare.run import ComparisonResult

SHIPPED = ("compare_mini", "compare_servicer")


@for_python
def compare(
    files: StrPath | Sequence[StrPath] = SHIPPED,
    *,
    out: StrPath = "out/compare",
    runs: int | None = None,
    workers: int | None = None,
    resume: bool = False,
    hooks: CampaignHooks | None = None,
) -> ComparisonResult:
    """Run campaigns that vary the law, and put what each law did side by side.

    Workers are processes that import the main module again: in a script, call this under
    ``if __name__ == "__main__":``.

    Args:
        files: shipped names or paths of campaign files.
        out: directory of everything that is written.
        runs: per point of the grid; None: what the files say.
        workers: worker processes; None: one per core.
        resume: go on with what is in the directory.
        hooks: progress and early end of each campaign.

    Returns:
        Medians by law, period and condition, and what a control cycle of each law costs.

    Raises:
        SpaceRobotError: a campaign cannot be run as it is, or Dask is not installed; nothing was written.
    """
    with needing("compare", "campaign"):
        from space_robot_bringup.campaign.run import check_options, run_campaign
        from space_robot_bringup.compare.run import checked_campaigns, run_comparisons
    from space_robot_bringup.reproduce.workers import cores

    check_options(workers, None, "none")
    listed = [files] if isinstance(files, str | os.PathLike) else files
    directory = Path(out)

    def run(campaign: Campaign, place: Path) -> CampaignResult:
        going_on = resume and place.exists()
        return run_campaign(campaign, place, workers=workers or cores(), resume=going_on, keep="none", hooks=hooks)

    return run_comparisons(checked_campaigns(listed, directory, runs=runs, resume=resume), directory, run)
