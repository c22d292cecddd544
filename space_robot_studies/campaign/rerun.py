"""One case of a campaign run by itself, in any mode, and compared with its row."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.logs.logged import confined
from space_robot_bringup.modes.run import RunResult
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.directory import begun_campaign, campaign_rows


def case_experiment(directory: Path, index: int, *, allow_code: bool = False) -> Experiment:
    """The experiment of a case; the directory may come from a third party, so it brings no code and names no file.

    Args:
        directory: of the campaign, finished or not.
        index: of the case.
        allow_code: the user vouches for the directory: robot files that it names are read.

    Raises:
        InputFileError: there is no campaign.
        SpecError: there is no such case, or it names a file.
    """
    case = make_case(begun_campaign(directory), index)
    if not allow_code:
        confined(case.data, f"case {index}")
    return case.experiment()


def differences(directory: Path, index: int, result: RunResult) -> list[str] | None:
    """What a run of a case shows otherwise than the campaign's row, number by number; None if there is no row yet."""
    row = campaign_rows(directory)[1].get(index)
    if row is None or row.lost or row.time_limit is not None:
        return None
    numbers = result.metrics.flat() if result.metrics is not None else {}
    found = {"end_reason": result.end_reason, "passed": result.passed, **numbers}
    kept = row.columns
    return [f"{name} is {found[name]}, was {kept.get(name)}" for name in found if found[name] != kept.get(name)]
