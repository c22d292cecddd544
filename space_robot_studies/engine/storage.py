"""The directory of a study: what it may be, and what the disk refuses becomes one error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from space_robot_msgs_py.atomic_file import TEMPORARY
from space_robot_msgs_py.errors import LogError, SpaceRobotError, SpecError


@contextmanager
def guarded(directory: Path) -> Iterator[None]:
    """Turn what the disk refuses into one LogError.

    Raises:
        LogError: with the system's reason.
    """
    try:
        yield
    except SpaceRobotError:
        raise
    except (OSError, ValueError) as error:
        # A null byte in a name is a ValueError.
        reason = getattr(error, "strerror", None) or str(error)
        raise LogError(f"nothing can be kept here: {reason}", key=str(directory)) from None


def check_place(directory: Path, accepted: str) -> None:
    """Refuse a directory that cannot be made, before a worker starts; nothing is written.

    Args:
        directory: as typed for ``--out``, or below that.
        accepted: what would do.

    Raises:
        SpecError: it is a file, or below one.
        LogError: the system cannot look it up.
    """
    with guarded(directory):
        there = next((place for place in (directory, *directory.absolute().parents) if place.exists()), directory)
        if there.exists() and not there.is_dir():
            what = "is a file" if there == directory else f"is below the file {there}"
            raise SpecError(what, key="--out", value=str(directory), accepted=accepted)


def check_study(
    directory: Path, what: str, resolved: str, identities: Callable[[], tuple[Mapping[str, Any], ...]], *, resume: bool
) -> None:
    """Refuse a directory a study cannot begin or be resumed in; nothing is written.

    Args:
        directory: as typed for ``--out``, or below that.
        what: the study is, in a word.
        resolved: name of the file that a study of that kind has from its beginning on.
        identities: what the study in there, and this one, have to have in common; called where there is one.
        resume: to go on with it.

    Raises:
        SpecError: it holds something else, or such a study and ``resume`` was not given.
        LogError: there can be no such directory.
    """
    key, new = "--out", "a new or empty directory"
    check_place(directory, new)
    with guarded(directory):
        there = directory.exists()
        begun = (directory / resolved).exists()
        if not begun and there and any(path.suffix != TEMPORARY for path in directory.iterdir()):
            raise SpecError(f"not empty and not a {what}", key=key, value=str(directory), accepted=new)
    if not begun:
        return
    if not resume:
        raise SpecError(f"holds a {what}", key=key, value=str(directory), accepted=f"--resume, or {new}")
    before, now = identities()
    different = [name for name in sorted(before.keys() | now.keys()) if before.get(name) != now.get(name)]
    if different:
        said = f"holds another {what} (not the same: {', '.join(different)})"
        raise SpecError(said, key=key, value=str(directory), accepted=f"the {what} it was begun with")
