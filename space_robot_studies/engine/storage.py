"""The directory of a study: what the disk refuses becomes one error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from space_robot_msgs_py.errors import LogError, SpaceRobotError


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
