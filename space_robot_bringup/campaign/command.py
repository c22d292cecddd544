"""``space-robot campaign``: what happens between the command line and the library."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from space_robot_bringup.campaign.cases import make_case
from space_robot_bringup.campaign.fly import Keep
from space_robot_bringup.campaign.run import CampaignHooks, CampaignResult, check_options, run_campaign
from space_robot_bringup.campaign.spec import Campaign
from space_robot_bringup.compiling import notice
from space_robot_bringup.progress import Progress
from space_robot_bringup.stopping import StopFlag


def fly(
    campaign: Campaign,
    directory: Path,
    *,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    keep: Keep,
    console: Console,
    quiet: bool,
    warn: Callable[[str], None],
) -> CampaignResult:
    """Fly a campaign with a progress bar; SIGINT and SIGTERM end it cleanly.

    Args:
        campaign: resolved.
        directory: where its rows go.
        workers: local ones; None: as many as there are cores.
        scheduler: address, instead of local workers.
        resume: go on with the directory.
        keep: whose bags to keep.
        console: for progress.
        quiet: no progress.
        warn: told what the law warns of.

    Raises:
        SpaceRobotError: it cannot be flown; nothing was written.
    """
    check_options(workers, scheduler, keep)
    laws = [make_case(campaign, index).data["controller"]["law"] for index in range(campaign.points)]
    if not quiet and (line := notice(laws, plant=scheduler is None)):
        console.print(line)
    cases = campaign.cases
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop, Progress(console, cases, quiet=quiet, unit="run") as progress:
        return run_campaign(
            campaign,
            directory,
            workers=workers or len(os.sched_getaffinity(0)),
            scheduler=scheduler,
            resume=resume,
            keep=keep,
            hooks=CampaignHooks(progress.begin, progress.reach, lambda: stop.reason, warn),
        )
