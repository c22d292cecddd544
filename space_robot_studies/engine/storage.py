"""The directory of a study: what it may be, and what the disk refuses becomes one error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
