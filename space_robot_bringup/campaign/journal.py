"""What a campaign has done so far, on disk: a kill at any time loses at most the runs in the air."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import IO, Any

from space_robot_bringup.campaign.files import TEMPORARY, guarded, write_whole
from space_robot_bringup.campaign.spec import Campaign
from space_robot_bringup.experiment import dump_yaml
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.bounded_files import is_file, read_text, short
from space_robot_msgs_py.errors import InputFileError, LogError, SpecError
from space_robot_msgs_py.limits import ROW_BYTES, ROWS_BYTES

CAMPAIGN, ROWS, RUNS = "resolved.yaml", "rows.jsonl", "runs"
# What every row of the table has, see ``table.FIXED``.
COLUMNS: Mapping[str, type] = {
    "index": int,
    "run": int,
    "seed": int,
    "end_reason": str,
    "completed": bool,
    "passed": bool,
    "failed": str,
    "ticks": int,
}


@dataclass(frozen=True, slots=True)
class Row:
    """One finished case.

    Attributes:
        index: of the case.
        columns: its row of the table.
        wall_time: [s]; not in the table, which depends on no machine.
        lost: the machinery failed, not the run; flown again by a resumed campaign.
        trace: traceback of a run that raised what it should not, or what is known of a lost one.
    """

    index: int
    columns: Mapping[str, Any]
    wall_time: float = 0.0
    lost: bool = False
    trace: str = ""

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Row:
        """A row from what a line of the file says, which may be anything.

        Raises:
            ValueError: it is no row.
            TypeError: it is no row.
        """
        row = cls(**data)
        kinds: dict[str, Any] = {"index": int, "wall_time": (int, float), "lost": bool, "trace": str, "columns": dict}
        for name, kind in kinds.items():
            if not isinstance(getattr(row, name), kind):
                raise ValueError(f"{name} is a {type(getattr(row, name)).__name__}")
        for name, wanted in COLUMNS.items():
            if type(row.columns[name]) is not wanted:
                raise ValueError(f"{name} is no {wanted.__name__}")
        if row.index < 0 or row.columns["index"] != row.index:
            raise ValueError("its number is not that of its case")
        for name, value in row.columns.items():
            if not isinstance(value, str | int | float | None) or (isinstance(value, float) and not isfinite(value)):
                raise ValueError(f"{name} is no text and no finite number")
        return row


class Journal:
    """The open directory of a campaign.

    Args:
        directory: where everything of the campaign is.
        stream: its rows, open at the end.
        rows: finished cases by index.
    """

    def __init__(self, directory: Path, stream: IO[str], rows: dict[int, Row]) -> None:
        self.directory, self.rows = directory, rows
        self._stream = stream

    def append(self, row: Row, bag: Mapping[str, bytes]) -> None:
        """Keep a row, its bag first: a row that is on disk is complete."""
        with guarded(self.directory):
            place = bag_path(self.directory, row.index)
            for name, content in bag.items():
                write_whole(place / name, content)
            self._stream.write(json.dumps(asdict(row), allow_nan=False) + "\n")
            self._stream.flush()
            os.fsync(self._stream.fileno())
        self.rows[row.index] = row


def bag_path(directory: Path, index: int) -> Path:
    """The run directory of a kept case."""
    return directory / RUNS / f"{index:06d}"


def begun_campaign(directory: Path) -> Campaign:
    """The resolved campaign of a directory.

    Raises:
        InputFileError: there is none.
    """
    path = directory / CAMPAIGN
    if not is_file(path):
        raise InputFileError("holds no campaign", key=short(directory), accepted=f"a directory with {CAMPAIGN}")
    return validate(Campaign, parse_yaml(path), str(path))


def check_directory(directory: Path, campaign: Campaign, *, resume: bool) -> None:
    """Refuse a directory this campaign cannot begin or go on in; nothing is written.

    Raises:
        SpecError: it holds something else, or this campaign and ``resume`` was not said.
        LogError: there can be no such directory.
    """
    key, new = "--out", "a new or empty directory"
    with guarded(directory):
        there = directory.exists()
        if there and not directory.is_dir():
            raise SpecError("is a file", key=key, value=str(directory), accepted=new)
        begun = (directory / CAMPAIGN).exists()
        if not begun and there and any(path.suffix != TEMPORARY for path in directory.iterdir()):
            raise SpecError("not empty and not a campaign", key=key, value=str(directory), accepted=new)
    if not begun:
        return
    if not resume:
        raise SpecError("holds a campaign", key=key, value=str(directory), accepted=f"--resume, or {new}")
    before, now = _identity(begun_campaign(directory)), _identity(campaign)
    different = [name for name in sorted(before.keys() | now.keys()) if before.get(name) != now.get(name)]
    if different:
        what = f"holds another campaign (not the same: {', '.join(different)})"
        raise SpecError(what, key=key, value=str(directory), accepted="the campaign it was begun with")


@contextmanager
def open_journal(directory: Path, campaign: Campaign, versions: Mapping[str, str]) -> Iterator[Journal]:
    """Begin or go on in a directory that ``check_directory`` lets pass.

    Args:
        directory: it is locked meanwhile.
        campaign: resolved.
        versions: of everything that can change the bits of a run.

    Raises:
        SpecError: somebody else is flying it, it was begun with other versions, or has more rows than cases.
        LogError: nothing can be written there.
    """
    with guarded(directory):
        directory.mkdir(parents=True, exist_ok=True)
        handle = os.open(directory, os.O_RDONLY)
    try:
        _lock(handle, directory)
        resolved = to_yaml(campaign).encode()
        with guarded(directory):
            # First, so that a kill right here leaves a campaign that can be resumed.
            if not (directory / CAMPAIGN).exists():
                write_whole(directory / CAMPAIGN, resolved)
            stream = (directory / ROWS).open("a+", encoding="utf-8")
        with stream:
            rows = _read(stream, directory, versions)
            if any(index >= campaign.cases for index in rows):
                raise SpecError("fewer than were flown", key="runs", value=campaign.runs, accepted="as many or more")
            with guarded(directory):
                write_whole(directory / CAMPAIGN, resolved)
                if not stream.tell():
                    stream.write(json.dumps({"versions": dict(versions)}) + "\n")
                    stream.flush()
            yield Journal(directory, stream, rows)
    finally:
        os.close(handle)


def to_yaml(campaign: Campaign) -> str:
    """The campaign as YAML text; a resolved one can be flown from it without any other file."""
    return dump_yaml(campaign.model_dump(mode="json", exclude_unset=True))


def _identity(campaign: Campaign) -> dict[str, Any]:
    """Everything but the number of runs: more of them leave the finished ones as they are."""
    return campaign.model_dump(mode="json", exclude={"runs"})


def _lock(handle: int, directory: Path) -> None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise SpecError("is being flown by another process", key="--out", value=str(directory)) from None


def finished_row(directory: Path, index: int) -> Row | None:
    """What came of a case so far.

    Raises:
        LogError: the rows are damaged.
    """
    return finished_rows(directory)[1].get(index)


def finished_rows(directory: Path) -> tuple[dict[str, str], dict[int, Row]]:
    """The versions a campaign is flown with, and its rows so far by index.

    Raises:
        LogError: the rows are damaged.
    """
    path = directory / ROWS
    return _parse(read_text(path, ROWS_BYTES), path) if is_file(path) else ({}, {})


def _read(stream: IO[str], directory: Path, versions: Mapping[str, str]) -> dict[int, Row]:
    """The rows so far; what a kill left of a line is cut off."""
    with guarded(directory / ROWS):
        stream.seek(0)
        text = stream.read()
        begun, rows = _parse(text, directory / ROWS)
        stream.truncate(len(text[: text.rfind("\n") + 1].encode()))
        stream.seek(0, os.SEEK_END)
    different = [f"{name} {begun.get(name)}" for name in versions if begun and begun.get(name) != versions[name]]
    if different:
        what = f"was begun with {', '.join(different)}, so its rows would not be comparable"
        raise SpecError(what, key="--resume", value=str(directory), accepted="these versions, or a new directory")
    return {index: row for index, row in rows.items() if not row.lost}


def _parse(text: str, path: Path) -> tuple[dict[str, str], dict[int, Row]]:
    """Versions, which are the first line, and the last word on each case; an unfinished line is left out."""
    versions, rows = dict[str, str](), dict[int, Row]()
    for number, line in enumerate(text.split("\n")[:-1]):
        try:
            ROW_BYTES.check(len(line), "a row")
            if number == 0:
                versions = {str(name): str(text) for name, text in json.loads(line)["versions"].items()}
            else:
                row = Row.of(json.loads(line))
                rows[row.index] = row
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise LogError(f"line {number + 1} is damaged ({error})", key=str(path)) from None
    return versions, rows
