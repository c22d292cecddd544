"""`space_robot.campaign`: a campaign file in, many runs and their statistics out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from space_robot_bringup.experiment.experiment import Overrides
from space_robot_bringup.public.calls import for_python, needing
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.campaign.campaign import CampaignResult
    from space_robot_studies.engine.hooks import StudyHooks


@for_python
def campaign(
    file: StrPath,
    overrides: Overrides | None = None,
    *,
    out: StrPath | None = None,
    runs: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    keep: Literal["failed", "all", "none"] = "failed",
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> CampaignResult:
    """Run a Monte Carlo campaign; the table does not depend on the number of workers.

    Args:
        file: a shipped name such as ``fig08_dispersed``, or the path of a YAML file.
        overrides: of the experiment, for all runs; see ``run``. A law may be a class of this program.
        out: directory of rows, bags, ``table.parquet`` and ``summary.json``; None: ``runs/<name>``.
        runs: per point of the grid; None: what the file says.
        workers: local worker processes; None: one per core.
        scheduler: address of a Dask scheduler instead of local workers.
        resume: go on with what is in the directory.
        keep: whose bags to keep.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Returns:
        Statistics by point of the grid, the verdict, and why the campaign ended.

    Raises:
        SpaceRobotError: the campaign cannot be run as it is, or a package is not installed; nothing was written.
    """
    with needing("campaign", "campaign"):
        from space_robot_studies.campaign.campaign import run_campaign
    from space_robot_studies.campaign.spec import campaign_path, load_campaign

    place = Path("runs") / campaign_path(file).stem if out is None else Path(out)
    return run_campaign(
        load_campaign(file, runs, overrides or ()),
        place,
        workers=workers,
        scheduler=scheduler,
        resume=resume,
        keep=keep,
        time_limit=time_limit,
        hooks=hooks,
    )
