"""The cases of a campaign as runs of a manifest: its experiment, and everything that is set of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_description.share import is_file
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import InputFileError, SpaceRobotError, SpecError
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.spec import Campaign, campaign_path, read_campaign, resolved, with_files
from space_robot_studies.reproduce.manifest import RunGroup


@dataclass(frozen=True, slots=True)
class CaseRun:
    """One case of a campaign.

    Attributes:
        run: which draws.
        labels: what is varied, by key, as tables show it.
        values: dotted key to value of everything that makes its experiment out of the campaign's.
    """

    run: int
    labels: Mapping[str, Any]
    values: Mapping[str, Any]


def campaign_cases(group: RunGroup, folder: Path, key: str) -> tuple[str, Iterator[CaseRun]]:
    """The experiment as the command line takes it, and the cases of the points that the group shows.

    Args:
        group: that names a campaign, or is one itself because it disperses something.
        folder: where a relative path starts.
        key: of the group, for errors.

    Raises:
        SpecError: there is no such campaign, it holds its experiment itself, or no point has the wanted values.
    """
    path, written = _own(group, folder, key) if group.disperse else _named(group, folder, key)
    if not isinstance(written.experiment, str):
        raise SpecError("holds its experiment itself", key=f"{key}.campaign", accepted="a campaign that names one")
    try:
        whole = resolved(written, path)
    except SpaceRobotError as error:
        raise SpecError(str(error), key=key) from None
    wanted = [at for at in range(whole.points) if group.where.items() <= whole.point(at).labels.items()]
    if not wanted:
        accepted = ", ".join(written.vary) or "nothing is varied"
        what = "no point of the grid has these values"
        raise SpecError(what, key=f"{key}.where", value=dict(group.where), accepted=accepted)
    experiment = path.parent / written.experiment
    argument = str(experiment) if is_file(experiment) else written.experiment
    return argument, _cases(whole, written.set, wanted)


def _named(group: RunGroup, folder: Path, key: str) -> tuple[Path, Campaign]:
    beside = folder / group.campaign
    name = str(beside) if is_file(beside) else group.campaign
    try:
        return campaign_path(name), read_campaign(name, group.runs)
    except InputFileError as error:
        raise SpecError(str(error), key=key) from None


def _own(group: RunGroup, folder: Path, key: str) -> tuple[Path, Campaign]:
    keys = group.model_fields_set & Campaign.model_fields.keys()
    written = validate(Campaign, {name: value for name, value in group if name in keys}, f"{key}.")
    return folder / "manifest.yaml", with_files(written, folder)


def _cases(campaign: Campaign, constant: Mapping[str, Any], points: list[int]) -> Iterator[CaseRun]:
    for at in points:
        for run in range(campaign.runs):
            case = make_case(campaign, run * campaign.points + at)
            values = {**constant, **campaign.point(at).values, **case.drawn, "seed": case.seed}
            yield CaseRun(run, case.labels, values)
