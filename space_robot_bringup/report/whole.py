"""Pages that are there whole or not at all."""

from __future__ import annotations

from pathlib import Path

from space_robot_msgs_py.errors import LogError


def write_whole(path: Path, text: str) -> None:
    """Write a text file, whole or not at all.

    Raises:
        LogError: it cannot be written.
    """
    temporary = path.with_name(f"{path.name}.tmp")
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(path)
    except OSError as error:
        raise LogError(f"cannot be written: {error.strerror or error}", key=str(path)) from None
