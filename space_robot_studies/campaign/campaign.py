"""One campaign from beginning to end: checked, run, kept, summarised."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, get_args

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.versions import versions
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.conclusion import FAIL, conclusion, passed
from space_robot_bringup.judge.metrics import PER_AXIS, metric_names
from space_robot_bringup.judge.verdict import check_bounds, check_expectations
from space_robot_bringup.public.calls import needing
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import LogError, SilenceError, SpecError
from space_robot_msgs_py.extras import install
from space_robot_studies.campaign.cases import check_cases, make_case
from space_robot_studies.campaign.directory import check_directory, open_campaign, to_yaml
from space_robot_studies.campaign.kinds import kind_of_case
from space_robot_studies.campaign.run_case import (
    CaseResult,
    Keep,
    failure,
    run_case,
    run_cases,
    warm,
)
from space_robot_studies.campaign.session_laws import packed_laws
from space_robot_studies.campaign.spec import Campaign, load_campaign
from space_robot_studies.campaign.statistics import RATES, Group, summarise, summary_names
from space_robot_studies.engine.groups import Grouping, run_in_groups
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.engine.journal import Journal, Row
from space_robot_studies.engine.storage import guarded
from space_robot_studies.engine.tasks import TIME_LIMIT, Lost, Task, Workers
from space_robot_studies.engine.workers import check_workers, open_workers

if TYPE_CHECKING:
    import pandas as pd

GROUPING: Grouping[CaseResult] = Grouping(lambda task: kind_of_case(task.arguments[0]), run_cases)
TABLE, SUMMARY = "table.parquet", "summary.json"
# What the table is made with, at the very end.
NEEDED = ("pyarrow",)


@dataclass(frozen=True, slots=True, weakref_slot=True)
class CampaignResult:
    """What a campaign left behind.

    Attributes:
        directory: where.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        done: finished cases.
        total: all cases.
        groups: summaries by point of the grid; empty unless completed.
        checks: the verdict, bound by bound.
        wall_time: [s] of the runs; start-up of the workers is not counted.
        lost: cases among the finished ones that a resumed campaign runs again.
    """

    directory: Path
    end_reason: str
    done: int
    total: int
    groups: tuple[Group, ...]
    checks: tuple[Check, ...]
    wall_time: float
    lost: int = 0

    def to_pandas(self) -> pd.DataFrame:
        """The table: a row per case by its index, with what was varied and drawn, the outcome and every metric.

        Raises:
            SpecError: pandas is not installed.
            LogError: the campaign was not completed, and has no table.
        """
        with needing("to_pandas", "pandas"):
            import pandas as pd
        if not self.groups:
            raise LogError(f"has no table: {self.end_reason}", key=str(self.directory), accepted="resume")
        return pd.read_parquet(self.directory / TABLE).set_index("index")

    @property
    def passed(self) -> bool | None:
        """Everything was run and every bound holds; None: but none of the task, see ``judge_groups``."""
        return passed(self.checks) if self.end_reason == "completed" else False

    @property
    def conclusion(self) -> str:
        """``PASS``, ``FAIL``, or in words that nothing was expected."""
        return conclusion(self.checks) if self.end_reason == "completed" else FAIL


def run_campaign(
    campaign: Campaign | str | Path,
    directory: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    keep: Keep = "failed",
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> CampaignResult:
    """Run a campaign.

    Args:
        campaign: a shipped name, a YAML file, or what ``load_campaign`` made of one.
        directory: new or empty, or to resume.
        workers: number of local worker processes; None: one per core. Not with ``scheduler``.
        scheduler: address of a Dask scheduler whose workers are used.
        resume: go on with what is in the directory.
        keep: whose bags to keep.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the campaign cannot be run as it is; nothing was written.
    """
    hooks = hooks or StudyHooks()
    check_workers(workers, scheduler, time_limit)
    if keep not in get_args(Keep):
        raise SpecError("no such choice", key="--keep", value=keep, accepted=", ".join(get_args(Keep)))
    loaded = campaign if isinstance(campaign, Campaign) else load_campaign(campaign)
    checked = CheckedCampaign.of(loaded, Path(directory), resume=resume, stop=hooks.stop)
    first = (warm, (make_case(loaded, 0).data, packed_laws(loaded, scheduler)))
    with open_workers(workers, time_limit=time_limit, scheduler=scheduler, warm=first, stop=hooks.stop) as pool:
        return checked.run(pool, keep, time_limit, hooks)


@dataclass(frozen=True, slots=True)
class CheckedCampaign:
    """A campaign that can be run in a directory as far as can be known before.

    Attributes:
        campaign: resolved.
        directory: where it goes.
        metrics: names of the numbers of its runs.
        warnings: what its laws warn of.
    """

    campaign: Campaign
    directory: Path
    metrics: tuple[str, ...]
    warnings: tuple[str, ...]

    @classmethod
    def of(
        cls, campaign: Campaign, directory: Path, *, resume: bool, stop: Callable[[], object] = lambda: None
    ) -> CheckedCampaign:
        """Check everything; see ``run_campaign``."""
        if missing := [name for name in NEEDED if find_spec(name) is None]:
            raise SpecError(f"a campaign needs {missing[0]}", accepted=install("campaign"))
        check_directory(directory, campaign, resume=resume)
        firsts = check_cases(campaign, stop)
        # Points may differ in their robot, and so in their metrics.
        metrics = tuple(dict.fromkeys(name for composition in firsts for name in _metrics(composition)))
        check_expectations(campaign.expect, summary_names(metrics))
        warnings = dict.fromkeys(warning for composition in firsts for warning in composition.review().warnings)
        return cls(campaign, directory, metrics, tuple(warnings))

    def run(self, pool: Workers, keep: Keep, time_limit: float, hooks: StudyHooks) -> CampaignResult:
        """Run what is not finished yet, and summarise; see ``run_campaign``."""
        for warning in self.warnings:
            hooks.warn(warning)
        total, groups, reason = self.campaign.cases, tuple[Group, ...](), ""
        with open_campaign(self.directory, self.campaign, versions(), time_limit) as journal:
            hooks.on_ready(len(journal.rows), total)
            began = perf_counter()
            pending = self._pending(journal, keep)
            try:
                for task, outcome in run_in_groups(pool, pending, total - len(journal.rows), GROUPING, hooks.stop):
                    self._enter(journal, int(task.key), outcome)
                    hooks.on_row(len(journal.rows))
            except SilenceError as error:
                reason = str(error)
            wall_time = perf_counter() - began
            done, lost = len(journal.rows), sum(not row.stands(time_limit) for row in journal.rows.values())
            if done == total:
                groups = self._conclude(journal)
        reason = "completed" if groups else reason or hooks.stop() or "interrupted"
        checks = judge_groups(self.campaign, groups)
        return CampaignResult(self.directory, reason, done, total, groups, checks, wall_time, lost)

    def _pending(self, journal: Journal, keep: Keep) -> Iterator[Task[CaseResult]]:
        finished = set(journal.rows)
        for index in range(self.campaign.cases):
            if index not in finished:
                data = make_case(self.campaign, index).data
                yield Task(index, run_case, (data, f"{index:06d}", keep))

    def _enter(self, journal: Journal, index: int, outcome: CaseResult | Lost) -> None:
        columns = make_case(self.campaign, index).columns()
        if isinstance(outcome, Lost):
            journal.append(Row.of_lost(index, columns | failure(outcome.reason), outcome))
        else:
            row = Row(index, columns | dict(outcome.columns), outcome.wall_time, trace=outcome.trace)
            journal.append(row, outcome.bag)

    def _conclude(self, journal: Journal) -> tuple[Group, ...]:
        """Write table and summary."""
        # Only here: Arrow starts threads, and a process with one thread is forked in no time.
        from space_robot_studies.campaign.table import parquet

        campaign = self.campaign
        rows = [journal.rows[index].columns for index in range(campaign.cases)]
        groups = tuple(
            summarise(rows[at :: campaign.points], campaign.point(at).labels, self.metrics)
            for at in range(campaign.points)
        )
        metadata = {"campaign": to_yaml(campaign), "versions": json.dumps(versions(), sort_keys=True)}
        summary = {"title": campaign.title, "runs": campaign.runs, "groups": [group.to_dict() for group in groups]}
        with guarded(journal.directory):
            write_atomically(journal.directory / TABLE, parquet(rows, metadata))
            write_atomically(journal.directory / SUMMARY, json.dumps(summary, indent=1, allow_nan=False) + "\n")
        return groups


def _metrics(composition: Composition) -> list[str]:
    return metric_names(composition.joint_names, base_translation=composition.nominal.base_mode == "free_flying")


def judge_groups(campaign: Campaign, groups: Sequence[Group]) -> tuple[Check, ...]:
    """The verdict: some run of every point of the grid completed, and the campaign's bounds hold at every point.

    Of the task are bounds on what an axis did, and on the rate of success where something is expected of runs.
    """
    checks = []
    for group in groups:
        where = f"{describe(group.labels)}: " if group.labels else ""
        count = group.completed.count
        checks.append(Check(f"{where}completed runs", count, ">= 1", count >= 1))
        numbers = group.flat()
        for name, wanted in campaign.expect.items():
            found = check_bounds(f"{where}{name}", numbers.get(name), wanted)
            checks += [replace(check, about="task") for check in found] if _of_task(name, group) else found
    return tuple(checks)


def _of_task(name: str, group: Group) -> bool:
    """Whether a number of a group is about what its runs were to do."""
    if name.partition(".")[0] == RATES[0]:
        return group.undecided < group.success.n
    return name.rpartition(".")[0].rpartition(".")[2] in PER_AXIS


def describe(labels: Mapping[str, Any]) -> str:
    """A point of the grid in words."""
    return ", ".join(f"{key}={value}" for key, value in labels.items())
