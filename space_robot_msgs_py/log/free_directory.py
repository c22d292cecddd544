"""Where a run may go: no run replaces another one unasked."""

from __future__ import annotations

from itertools import count
from pathlib import Path

from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.directory import BAG_SUFFIX


def holds_run(directory: Path) -> bool:
    """True where a bag is in a directory, finished or not."""
    try:
        return any(path.name.endswith(BAG_SUFFIX) for path in directory.iterdir())
    except (OSError, ValueError):
        # What is no directory is refused by who opens it, with the reason.
        return False


def checked_directory(directory: Path, *, overwrite: bool, key: str = "--out") -> Path:
    """The directory that was asked for.

    Args:
        directory: of the run.
        overwrite: a run that is in it may be replaced.
        key: what was typed, for the error.

    Raises:
        SpecError: a run is in it.
    """
    if not overwrite and holds_run(directory):
        accepted = "a directory without a run, or overwrite (--overwrite, overwrite=True, overwrite:=true)"
        raise SpecError("holds a run already", key=key, value=short(directory), accepted=accepted)
    return directory


def free_directory(directory: Path, *, overwrite: bool = False) -> Path:
    """A directory that was not asked for: with a number where one of that name holds a run: fig08, fig08_2, fig08_3."""
    if overwrite or not holds_run(directory):
        return directory
    numbered = (directory.with_name(f"{directory.name}_{number}") for number in count(2))
    return next(place for place in numbered if not holds_run(place))
