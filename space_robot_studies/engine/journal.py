"""What a study has done so far, on disk: a crash at any time loses at most the runs in progress."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from time import monotonic
from typing import IO, Any

from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.bounded_files import is_file, read_text
from space_robot_msgs_py.errors import LogError, SpecError
from space_robot_msgs_py.limits import ROW_BYTES, ROWS_BYTES
from space_robot_studies.engine.storage import guarded
from space_robot_studies.engine.tasks import Lost

ROWS, RUNS = "rows.jsonl", "runs"
# Between two waits for the disk, which takes as long as a run.
SYNC_SECONDS = 1.0
Key = int | str
Rows = dict[Key, "Row"]
Check = Callable[["Row"], None]


@dataclass(frozen=True, slots=True)
class Row:
    """One finished run.

    Attributes:
        key: index of a case, or name of a run.
        columns: what is known of it.
        wall_time: [s]; not in any table, which depends on no machine.
        lost: the machinery failed or a limit ended it, not the run; a resumed study runs it again.
        trace: traceback of a run that raised what it should not, or what is known of a lost one.
        time_limit: [s] that ended it; run again only with a larger one.
    """

    key: Key
    columns: Mapping[str, Any]
    wall_time: float = 0.0
    lost: bool = False
    trace: str = ""
    time_limit: float | None = None

    @classmethod
    def of_lost(cls, key: Key, columns: Mapping[str, Any], lost: Lost) -> Row:
        """The row of a run without a result; what it raised itself is its result."""
        failed = lost.time_limit is None and not lost.reason.startswith("bug:")
        return cls(key, columns, lost=failed, trace=lost.detail, time_limit=lost.time_limit)

    def stands(self, time_limit: float) -> bool:
        """Whether a resumed study with this limit [s] leaves the run as it is."""
        return not self.lost and (self.time_limit is None or time_limit <= self.time_limit)


class Journal:
    """The open rows of a study.

    Args:
        directory: where everything of the study is.
        stream: its rows, open at the end.
        rows: finished runs by key.
    """

    def __init__(self, directory: Path, stream: IO[str], rows: Rows) -> None:
        self.directory, self.rows = directory, rows
        self._stream = stream
        self._synced = monotonic()

    def append(self, row: Row, bag: Mapping[str, bytes] | None = None) -> None:
        """Keep a row, its bag first: a row that is on disk is complete.

        A row survives this process at once, and a power cut after a second: the disk takes as long as a run.
        """
        with guarded(self.directory):
            place = bag_path(self.directory, row.key)
            for name, content in (bag or {}).items():
                (place / name).parent.mkdir(parents=True, exist_ok=True)
                write_atomically(place / name, content)
            self._stream.write(json.dumps(asdict(row), allow_nan=False) + "\n")
            self._stream.flush()
            if monotonic() - self._synced >= SYNC_SECONDS:
                self.sync()
        self.rows[row.key] = row

    def sync(self) -> None:
        """Put all rows on disk."""
        os.fsync(self._stream.fileno())
        self._synced = monotonic()


def bag_path(directory: Path, key: Key) -> Path:
    """The run directory of a kept run."""
    return directory / RUNS / (f"{key:06d}" if isinstance(key, int) else key)


@contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Make a directory and keep other studies out of it.

    Raises:
        SpecError: another process is at work in it.
        LogError: there can be no such directory.
    """
    with guarded(directory):
        directory.mkdir(parents=True, exist_ok=True)
        handle = os.open(directory, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise SpecError("is in use by another process", key="--out", value=str(directory)) from None
        yield
    finally:
        os.close(handle)


def _any_columns(row: Row) -> None:
    del row


@contextmanager
def open_journal(
    directory: Path, versions: Mapping[str, str], time_limit: float, check: Check = _any_columns
) -> Iterator[Journal]:
    """Begin or resume the rows of a locked directory; what a crash left of a line is cut off.

    Args:
        directory: see ``locked``.
        versions: of everything that can change the bits of a run.
        time_limit: [s]; rows that a smaller one ended are left out.
        check: raises a LogError for columns this study cannot have.

    Raises:
        SpecError: the rows were begun with other versions.
        LogError: they are corrupted, or cannot be written.
    """
    path = directory / ROWS
    with guarded(directory):
        stream = path.open("a+", encoding="utf-8")
    with stream:
        with guarded(path):
            stream.seek(0)
            text = stream.read()
            begun, rows = _parse(text, path, check)
            _check_versions(begun, versions, directory)
            stream.truncate(len(text[: text.rfind("\n") + 1].encode()))
            stream.seek(0, os.SEEK_END)
            if not stream.tell():
                stream.write(json.dumps({"versions": dict(versions)}) + "\n")
                stream.flush()
        journal = Journal(directory, stream, {key: row for key, row in rows.items() if row.stands(time_limit)})
        try:
            yield journal
        finally:
            with guarded(path):
                journal.sync()


def finished_rows(directory: Path, check: Check = _any_columns) -> tuple[dict[str, str], Rows]:
    """The versions a study is run with, and its rows so far by key.

    Args:
        directory: of the study.
        check: raises a LogError for columns this study cannot have.

    Raises:
        LogError: the rows are corrupted.
    """
    path = directory / ROWS
    return _parse(read_text(path, ROWS_BYTES), path, check) if is_file(path) else ({}, {})


def finished_row(directory: Path, key: Key) -> Row | None:
    """What came of a run so far.

    Raises:
        LogError: the rows are corrupted.
    """
    return finished_rows(directory)[1].get(key)


def _check_versions(begun: Mapping[str, str], versions: Mapping[str, str], directory: Path) -> None:
    different = [f"{name} {begun.get(name)}" for name in versions if begun and begun.get(name) != versions[name]]
    if different:
        what = f"was begun with {', '.join(different)}, so its rows would not be comparable"
        raise SpecError(what, key="--resume", value=str(directory), accepted="these versions, or a new directory")


def _parse(text: str, path: Path, check: Check) -> tuple[dict[str, str], Rows]:
    """Versions, which are the first line, and the last row of each run; an unfinished line is left out."""
    versions, rows = dict[str, str](), Rows()
    for number, line in enumerate(text.split("\n")[:-1]):
        try:
            ROW_BYTES.check(len(line), "a row")
            if number == 0:
                versions = {str(name): str(text) for name, text in json.loads(line)["versions"].items()}
            else:
                row = _row(json.loads(line))
                check(row)
                rows[row.key] = row
        except (LogError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise LogError(f"line {number + 1} is corrupted ({error})", key=str(path)) from None
    return versions, rows


def _row(fields: dict[str, Any]) -> Row:
    # Campaigns begun before 0.2 call their key index.
    if "index" in fields:
        fields["key"] = fields.pop("index")
    row = Row(**fields)
    kinds: dict[str, Any] = {"key": (int, str), "wall_time": (int, float), "lost": bool, "trace": str, "columns": dict}
    for name, kind in kinds.items():
        if not isinstance(getattr(row, name), kind):
            raise ValueError(f"{name} is a {type(getattr(row, name)).__name__}")
    if isinstance(row.key, bool) or (isinstance(row.key, int) and row.key < 0):
        raise ValueError("its key is no number of a case")
    return row


def check_columns(row: Row, wanted: Mapping[str, tuple[type, ...]]) -> None:
    """Refuse columns that a table of plain numbers and texts cannot hold; a file may contain anything.

    Args:
        row: as read; the readers of a journal add its line to the error.
        wanted: columns that every row has, and their types.

    Raises:
        LogError: a column is missing or of another type, or a number is not finite.
    """
    for name, kinds in wanted.items():
        if name not in row.columns or type(row.columns[name]) not in kinds:
            raise LogError(f"{name} is no {kinds[0].__name__}", key=f"row {row.key}")
    for name, value in row.columns.items():
        if not isinstance(value, str | int | float | None) or (isinstance(value, float) and not isfinite(value)):
            raise LogError(f"{name} is no text and no finite number", key=f"row {row.key}")
