"""One campaign from beginning to end: checked, flown, kept, summed up."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, get_args

from space_robot_bringup.campaign import journal
from space_robot_bringup.campaign.cases import Case, check_cases, make_case
from space_robot_bringup.campaign.cluster import workers_at
from space_robot_bringup.campaign.files import guarded, write_whole
from space_robot_bringup.campaign.fleet import Lost, fly_cases
from space_robot_bringup.campaign.fly import Flown, Keep, failure
from space_robot_bringup.campaign.journal import Journal, Row
from space_robot_bringup.campaign.spec import Campaign
from space_robot_bringup.campaign.summary import Group, summarise, summary_names
from space_robot_bringup.campaign.table import parquet
from space_robot_bringup.compose import Composition, versions
from space_robot_bringup.metrics import metric_names
from space_robot_bringup.verdict import Check, check_bounds, check_expectations
from space_robot_msgs_py.errors import SilenceError, SpecError

TABLE, SUMMARY = "table.parquet", "summary.json"
MOST_WORKERS = 1024


@dataclass(frozen=True, slots=True)
class CampaignHooks:
    """How a campaign talks to whoever started it.

    Attributes:
        on_ready: told when the workers are ready how many rows are there already.
        on_row: told each time how many there are now.
        stop: asked often; a reason ends the campaign.
        warn: told before the first flight what the law warns of.
    """

    on_ready: Callable[[int], None] = lambda done: None
    on_row: Callable[[int], None] = lambda done: None
    stop: Callable[[], str | None] = lambda: None
    warn: Callable[[str], None] = lambda warning: None


@dataclass(frozen=True, slots=True)
class CampaignResult:
    """What a campaign left behind.

    Attributes:
        directory: where.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        done: finished cases.
        total: all cases.
        groups: summaries by point of the grid; empty unless completed.
        checks: the verdict, bound by bound.
        wall_time: [s] of flying; start-up of the workers is not counted.
    """

    directory: Path
    end_reason: str
    done: int
    total: int
    groups: tuple[Group, ...]
    checks: tuple[Check, ...]
    wall_time: float

    @property
    def passed(self) -> bool:
        """Everything was flown and every bound holds."""
        return self.end_reason == "completed" and all(check.passed for check in self.checks)


def run_campaign(
    campaign: Campaign,
    directory: Path,
    *,
    workers: int,
    scheduler: str | None = None,
    resume: bool = False,
    keep: Keep = "failed",
    hooks: CampaignHooks | None = None,
) -> CampaignResult:
    """Fly a campaign.

    Args:
        campaign: resolved, see ``load_campaign``.
        directory: new or empty, or to resume.
        workers: number of local worker processes; unused with ``scheduler``.
        scheduler: address of a Dask scheduler whose workers fly.
        resume: go on with what is in the directory.
        keep: whose bags to keep.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the campaign cannot be flown as it is; nothing was written.
    """
    hooks = hooks or CampaignHooks()
    journal.check_directory(directory, campaign, resume=resume)
    firsts = check_cases(campaign)
    # Points may differ in their robot, and so in their metrics.
    metrics = list(dict.fromkeys(name for composition in firsts for name in _metrics(composition)))
    check_expectations(campaign.expect, summary_names(metrics))
    for warning in dict.fromkeys(warning for composition in firsts for warning in composition.review().warnings):
        hooks.warn(warning)
    with (
        workers_at(scheduler, workers, make_case(campaign, 0).data) as client,
        journal.open_journal(directory, campaign, versions()) as book,
    ):
        everything = campaign.cases
        hooks.on_ready(len(book.rows))
        began = perf_counter()
        left = (make_case(campaign, index) for index in range(everything) if index not in book.rows)
        reason = None
        try:
            for case, outcome in fly_cases(client, left, keep, hooks.stop):
                _enter(book, case, outcome)
                hooks.on_row(len(book.rows))
        except SilenceError as error:
            reason = str(error)
        wall_time = perf_counter() - began
        done = len(book.rows)
        groups = _conclude(campaign, book, metrics) if done == everything else ()
    reason = "completed" if groups else reason or hooks.stop() or "interrupted"
    return CampaignResult(directory, reason, done, everything, groups, judge_groups(campaign, groups), wall_time)


def check_options(workers: int | None, scheduler: str | None, keep: str) -> None:
    """Refuse what no campaign can be run with.

    Raises:
        SpecError: an option cannot be used.
    """
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise SpecError("not a number of workers", key="--workers", value=workers, accepted=f"1 to {MOST_WORKERS}")
    if workers is not None and scheduler is not None:
        raise SpecError("has workers of its own", key="--scheduler", value=scheduler, accepted="it or --workers")
    if keep not in get_args(Keep):
        raise SpecError("no such choice", key="--keep", value=keep, accepted=", ".join(get_args(Keep)))


def _enter(book: Journal, case: Case, outcome: Flown | Lost) -> None:
    if isinstance(outcome, Lost):
        columns = case.columns() | failure(outcome.reason)
        book.append(Row(case.index, columns, lost=True, trace=outcome.detail), {})
    else:
        columns = case.columns() | dict(outcome.columns)
        book.append(Row(case.index, columns, outcome.wall_time, trace=outcome.trace), outcome.bag)


def _metrics(composition: Composition) -> list[str]:
    return metric_names(composition.joint_names, base_translation=composition.nominal.base_mode == "free_flying")


def _conclude(campaign: Campaign, book: Journal, metrics: Sequence[str]) -> tuple[Group, ...]:
    """Write table and summary."""
    rows = [book.rows[index].columns for index in range(campaign.cases)]
    groups = tuple(
        summarise(rows[at :: campaign.points], campaign.point(at).labels, metrics, campaign.seed)
        for at in range(campaign.points)
    )
    metadata = {"campaign": journal.to_yaml(campaign), "versions": json.dumps(versions(), sort_keys=True)}
    summary = {"title": campaign.title, "runs": campaign.runs, "groups": [group.to_dict() for group in groups]}
    with guarded(book.directory):
        write_whole(book.directory / TABLE, parquet(rows, metadata))
        write_whole(book.directory / SUMMARY, (json.dumps(summary, indent=1, allow_nan=False) + "\n").encode())
    return groups


def judge_groups(campaign: Campaign, groups: Sequence[Group]) -> tuple[Check, ...]:
    """The verdict: some run of every point of the grid completed, and the campaign's bounds hold at every point."""
    checks = []
    for group in groups:
        where = f"{describe(group.labels)}: " if group.labels else ""
        count = group.completed.count
        checks.append(Check(f"{where}completed runs", count, ">= 1", count >= 1))
        numbers = group.flat()
        for name, wanted in campaign.expect.items():
            checks += check_bounds(f"{where}{name}", numbers.get(name), wanted)
    return tuple(checks)


def describe(labels: Mapping[str, Any]) -> str:
    """A point of the grid in words."""
    return ", ".join(f"{key}={value}" for key, value in labels.items())
