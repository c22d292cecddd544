"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from space_robot_msgs_py.errors import LogError, SpaceRobotError

TEMPORARY = ".tmp"


def write_whole(path: Path, content: bytes) -> None:
    """Write a file so that a kill leaves the old one or the new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + TEMPORARY)
    with temporary.open("wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(path)


@contextmanager
def guarded(directory: Path) -> Iterator[None]:
    """What the disk refuses becomes one LogError.

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
        raise LogError(f"no campaign can be kept here: {reason}", key=str(directory)) from None
