"""How runs, campaigns and replays look as suites of test cases."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.modes.run import RunResult
from space_robot_bringup.replay.replay import Replayed
from space_robot_bringup.replay.result import Outcome
from space_robot_cli.junit import Case, Suite, check_cases
from space_robot_cli.render.replay import in_words
from space_robot_studies.campaign.campaign import CampaignResult, describe
from space_robot_studies.campaign.directory import campaign_rows
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.engine.journal import Row


def run_suite(name: str, experiment: Experiment, mode: str, result: RunResult) -> Suite:
    """A run: a test case per check; remarks are said beside them."""
    properties = {
        "title": experiment.title,
        "law": experiment.controller.law,
        "seed": str(experiment.seed),
        "mode": mode,
        "end_reason": result.end_reason,
        "verdict": result.conclusion,
    }
    cases = tuple(check_cases(result.checks, result.end_reason))
    return Suite(name, cases, properties, result.wall_time, [f"remark: {one.line}" for one in result.remarks])


def campaign_suites(name: str, campaign: Campaign, result: CampaignResult) -> Iterator[Suite]:
    """A campaign: a suite per point of the grid with a test case per run, and one of what is expected of all."""
    properties = {"title": campaign.title, "seed": str(campaign.seed), "end_reason": result.end_reason}
    rows = campaign_rows(result.directory)[1]
    for at in range(campaign.points):
        said = describe(campaign.point(at).labels)
        indices = range(at, campaign.cases, campaign.points)
        cases = [_case(index, rows.get(index), result.end_reason) for index in indices]
        yield Suite(f"{name}: {said}" if said else name, cases, properties)
    verdict = tuple(check_cases(result.checks, result.end_reason))
    yield Suite(f"{name}: verdict", verdict, properties | {"verdict": result.conclusion}, 0.0)


def replay_suite(done: Replayed, bag: Path) -> Suite:
    """A replay: a test case per side that was computed again."""
    recording = done.recording
    changed = {f"changed: {key}": f"{was} -> {now}" for key, (was, now) in recording.changes.items()}
    properties = {"bag": str(bag), "end_reason": str(recording.end_reason), **changed}
    return Suite(bag.name or str(bag), tuple(map(_side, done.outcomes)), properties, said=recording.remarks)


def _case(index: int, row: Row | None, end_reason: str) -> Case:
    if row is None:
        return Case(f"case {index}", "skipped", f"not run: {end_reason}")
    columns: Mapping[str, Any] = row.columns
    name, reason, seconds = f"case {index}, seed {columns['seed']}", columns["end_reason"], row.wall_time
    if not columns["completed"]:
        return Case(name, "error", reason, row.trace, seconds)
    if columns["passed"] is False:
        return Case(name, "failure", f"missed: {columns['failed']}", seconds=seconds)
    if columns["passed"] is None:
        return Case(name, "skipped", "nothing was expected of the task", seconds=seconds)
    return Case(name, seconds=seconds)


def _side(outcome: Outcome) -> Case:
    name = outcome.against
    if outcome.first is not None:
        worst = "\n".join(in_words(found) for found in outcome.comparison.worst.values())
        return Case(
            name, "failure", f"first different: {in_words(outcome.first)}", f"the worst of each block:\n{worst}"
        )
    return Case(name) if outcome.comparison.compared else Case(name, "skipped", "nothing of it is in the log")
