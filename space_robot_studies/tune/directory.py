"""The directory of a tuning: its resolved file, and a row per evaluation."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import LogError
from space_robot_studies.engine.journal import Journal, Row, check_columns, locked, open_journal
from space_robot_studies.engine.storage import check_study, guarded
from space_robot_studies.tune.spec import Tuning

RESOLVED = "resolved.yaml"
COLUMNS: Mapping[str, tuple[type, ...]] = {"gains": (str,), "draws": (str,)}
Draws = Sequence[Mapping[str, Any]]


def check_directory(directory: Path, tuning: Tuning, *, resume: bool) -> None:
    """Refuse a directory this tuning cannot begin or be resumed in; nothing is written.

    Raises:
        SpecError: it holds something else, or this tuning and ``resume`` was not given.
        LogError: there can be no such directory.
    """
    path = directory / RESOLVED
    check_study(
        directory,
        "tuning",
        RESOLVED,
        lambda: (_identity(validate(Tuning, parse_yaml(path), str(path))), _identity(tuning)),
        resume=resume,
    )


@contextmanager
def open_tuning(directory: Path, tuning: Tuning, versions: Mapping[str, str], time_limit: float) -> Iterator[Journal]:
    """Begin or resume in a directory that ``check_directory`` lets pass; it is locked meanwhile.

    Raises:
        SpecError: another process is at work in it, or it was begun with other versions.
        LogError: nothing can be written there.
    """
    with locked(directory):
        with guarded(directory):
            write_atomically(directory / RESOLVED, dump_yaml(tuning.model_dump(mode="json", exclude_unset=True)))
        with open_journal(directory, versions, time_limit, _check) as journal:
            yield journal


def columns(gains: Mapping[str, float], draws: Draws) -> dict[str, str]:
    """What a row says of an evaluation."""
    return {"gains": json.dumps(dict(gains)), "draws": json.dumps([dict(draw) for draw in draws], allow_nan=False)}


def known(journal: Journal, key: str, gains: Mapping[str, float]) -> Draws | None:
    """The draws of an evaluation that is done; None: it is not, or other gains were tried under its number."""
    row = journal.rows.get(key)
    if row is None or json.loads(str(row.columns["gains"])) != dict(gains):
        return None
    draws: Draws = json.loads(str(row.columns["draws"]))
    return draws


def _check(row: Row) -> None:
    """Refuse a row that is not of an evaluation."""
    check_columns(row, COLUMNS)
    for name in COLUMNS:
        try:
            value = json.loads(row.columns[name])
        except ValueError:
            value = None
        if not isinstance(value, dict if name == "gains" else list):
            raise LogError(f"{name} are none", key=f"row {row.key}")


def _identity(tuning: Tuning) -> dict[str, Any]:
    """Everything but the budget: a larger one only adds evaluations."""
    return tuning.model_dump(mode="json", exclude={"budget"})
