"""The directory of a campaign: what it must hold to be begun or resumed, and its resolved file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import NoneType
from typing import Any

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.bounded_files import is_file, short
from space_robot_msgs_py.errors import InputFileError, LogError, SpecError
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.engine.journal import Journal, Row, check_columns, finished_rows, locked, open_journal
from space_robot_studies.engine.storage import check_study, guarded

CAMPAIGN = "resolved.yaml"
# What every row of the table has, see ``table.FIXED``, and of which types it may be; older rows have no remarks.
COLUMNS: Mapping[str, tuple[type, ...]] = {
    "index": (int,),
    "run": (int,),
    "seed": (int,),
    "end_reason": (str,),
    "completed": (bool,),
    "passed": (bool, NoneType),
    "failed": (str,),
    "ticks": (int,),
}


def begun_campaign(directory: Path) -> Campaign:
    """The resolved campaign of a directory.

    Raises:
        InputFileError: there is none.
    """
    path = directory / CAMPAIGN
    if not is_file(path):
        raise InputFileError("holds no campaign", key=short(directory), accepted=f"a directory with {CAMPAIGN}")
    return validate(Campaign, parse_yaml(path), str(path))


def campaign_rows(directory: Path) -> tuple[dict[str, str], dict[int, Row]]:
    """The versions a campaign is run with, and its rows so far by index.

    Raises:
        LogError: the rows are corrupted.
    """
    versions, rows = finished_rows(directory, _check_case)
    return versions, {index: row for index, row in rows.items() if isinstance(index, int)}


def _check_case(row: Row) -> None:
    """Refuse a row that is not of a case of a campaign."""
    check_columns(row, COLUMNS)
    if not isinstance(row.key, int) or row.columns["index"] != row.key:
        raise LogError("its number is not that of its case", key=f"row {row.key}")


def check_directory(directory: Path, campaign: Campaign, *, resume: bool) -> None:
    """Refuse a directory this campaign cannot begin or be resumed in; nothing is written.

    Raises:
        SpecError: it holds something else, or this campaign and ``resume`` was not given.
        LogError: there can be no such directory.
    """
    check_study(
        directory,
        "campaign",
        CAMPAIGN,
        lambda: (_identity(begun_campaign(directory)), _identity(campaign)),
        resume=resume,
    )


@contextmanager
def open_campaign(
    directory: Path, campaign: Campaign, versions: Mapping[str, str], time_limit: float
) -> Iterator[Journal]:
    """Begin or resume in a directory that ``check_directory`` lets pass.

    Args:
        directory: it is locked meanwhile.
        campaign: resolved.
        versions: of everything that can change the bits of a run.
        time_limit: [s] of CPU time of a run.

    Raises:
        SpecError: another process is at work in it, it was begun with other versions, or has more rows than cases.
        LogError: nothing can be written there.
    """
    with locked(directory):
        resolved = to_yaml(campaign).encode()
        with guarded(directory):
            # First, so that a crash right here leaves a campaign that can be resumed.
            if not (directory / CAMPAIGN).exists():
                write_atomically(directory / CAMPAIGN, resolved)
        with open_journal(directory, versions, time_limit, _check_case) as journal:
            if any(not isinstance(index, int) or index >= campaign.cases for index in journal.rows):
                raise SpecError("fewer than were run", key="runs", value=campaign.runs, accepted="as many or more")
            with guarded(directory):
                write_atomically(directory / CAMPAIGN, resolved)
            yield journal


def to_yaml(campaign: Campaign) -> str:
    """The campaign as YAML text; a resolved one can be run from it without any other file."""
    return dump_yaml(campaign.model_dump(mode="json", exclude_unset=True))


def _identity(campaign: Campaign) -> dict[str, Any]:
    """Everything but the number of runs: more of them leave the finished ones as they are."""
    return campaign.model_dump(mode="json", exclude={"runs"})
