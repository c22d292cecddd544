"""One case of a campaign run by itself, in any mode, and compared with its row."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.modes.run import RunResult
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.directory import begun_campaign
from space_robot_studies.engine.journal import finished_row


def case_experiment(directory: Path, index: int) -> Experiment:
    """The experiment of a case.

    Args:
        directory: of the campaign, finished or not.
        index: of the case.

    Raises:
        InputFileError: there is no campaign.
        SpecError: there is no such case.
    """
    return make_case(begun_campaign(directory), index).experiment()


def differences(directory: Path, index: int, result: RunResult) -> list[str] | None:
    """What a run of a case shows otherwise than the campaign's row, number by number; None if there is no row yet."""
    row = finished_row(directory, index)
    if row is None or row.lost or row.time_limit is not None:
        return None
    numbers = result.metrics.flat() if result.metrics is not None else {}
    found = {"end_reason": result.end_reason, "passed": result.passed, **numbers}
    kept = row.columns
    return [f"{name} is {found[name]}, was {kept.get(name)}" for name in found if found[name] != kept.get(name)]
