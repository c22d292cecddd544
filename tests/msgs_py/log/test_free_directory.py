"""No run replaces another one unasked."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.directory import BAG_SUFFIX
from space_robot_msgs_py.log.free_directory import checked_directory, free_directory


def put_run(directory: Path) -> None:
    directory.mkdir(parents=True)
    (directory / f"{directory.name}{BAG_SUFFIX}").write_bytes(b"")


def test_a_directory_that_was_asked_for_is_refused_where_it_holds_a_run(tmp_path: Path) -> None:
    """Unless it may be replaced; a new, an empty and no directory are left to who makes it."""
    put_run(tmp_path / "run")
    with pytest.raises(SpecError, match=r"^--out: holds a run already; got .*run'?; accepted: "):
        checked_directory(tmp_path / "run", overwrite=False)
    assert checked_directory(tmp_path / "run", overwrite=True) == tmp_path / "run"
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").touch()
    for name in ("new", "empty", "file", "x" * 5000, "a\0b"):
        assert checked_directory(tmp_path / name, overwrite=False) == tmp_path / name


def test_a_directory_that_was_not_asked_for_gets_a_number(tmp_path: Path) -> None:
    """The first that is free."""
    assert free_directory(tmp_path / "run") == tmp_path / "run"
    for name in ("run", "run_2", "run_4"):
        put_run(tmp_path / name)
    assert free_directory(tmp_path / "run") == tmp_path / "run_3"
    assert free_directory(tmp_path / "run", overwrite=True) == tmp_path / "run"
