"""Atomic file replacement: after a crash there is the old file or the new one, never a part."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from space_robot_msgs_py.errors import LogError

TEMPORARY = ".tmp"


def write_atomically(path: Path, content: bytes | str) -> None:
    """Write a file into a folder that exists; text is encoded as UTF-8.

    Raises:
        LogError: it cannot be written.
    """
    temporary = path.with_name(path.name + TEMPORARY)
    try:
        with temporary.open("wb") as stream:
            stream.write(content.encode() if isinstance(content, str) else content)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except BaseException as error:
        # Also where a signal ends the process: nothing is left beside the file.
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise LogError(f"cannot be written: {error.strerror or error}", key=str(path)) from None
        raise
