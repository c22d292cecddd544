"""Files of third parties: what kind of thing a path names, and texts of it up to a size."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Literal

from space_robot_msgs_py.errors import InputFileError, SpaceRobotError
from space_robot_msgs_py.limits import Limit

Kind = Literal["file", "directory", "other", "none"]


def path_kind(path: Path) -> Kind:
    """What a path names: ``other`` is a pipe, a device or a socket; a name no system can look up is ``none``."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return "none"
    return "file" if stat.S_ISREG(mode) else "directory" if stat.S_ISDIR(mode) else "other"


def is_file(path: Path) -> bool:
    """True if there is such a file, none that never ends or never begins."""
    return path_kind(path) == "file"


def is_directory(path: Path) -> bool:
    """True if there is such a directory."""
    return path_kind(path) == "directory"


def read_bytes(path: Path, limit: Limit, key: str = "") -> bytes:
    """The content of a file.

    Args:
        path: of a regular file: pipes and devices may have no end.
        limit: of its size [bytes]; no more is ever read, whatever the file says of its size.
        key: what to call it in an error; default: the path.

    Raises:
        InputFileError: there is no such file, it is too large, or cannot be read.
    """
    key = key or short(path)
    with open_regular(path, key) as stream:
        data = stream.read(limit.most + 1)
    if len(data) > limit.most:
        raise limit.exceeded(key, error=InputFileError)
    return data


@contextmanager
def open_regular(path: Path, key: str = "") -> Iterator[IO[bytes]]:
    """A file, open for reading; what goes wrong with it while it is read is an InputFileError as well.

    Args:
        path: of a regular file.
        key: what to call it in an error; default: the path.

    Raises:
        InputFileError: there is no such file, it is a directory, a pipe or a device, or cannot be read.
    """
    key = key or short(path)
    try:
        # Without O_NONBLOCK opening a pipe waits for a writer, before its kind could be looked at.
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        raise InputFileError("no such file", key=key) from None
    except (OSError, ValueError) as error:
        # A null byte in a name is a ValueError.
        raise InputFileError(f"cannot be read: {getattr(error, 'strerror', None) or error}", key=key) from None
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise InputFileError("is no regular file", key=key, accepted="a file, not a directory, pipe or device")
    with os.fdopen(handle, "rb") as stream:
        try:
            yield stream
        except SpaceRobotError:
            raise
        except OSError as error:
            raise InputFileError(f"cannot be read: {error.strerror or error}", key=key) from None


def read_text(path: Path, limit: Limit, key: str = "") -> str:
    """The text of a file in UTF-8; see ``read_bytes``.

    Raises:
        InputFileError: as ``read_bytes``, or it is no UTF-8.
    """
    data = read_bytes(path, limit, key)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        what = f"cannot be read as UTF-8 text: {error.reason} at byte {error.start}"
        raise InputFileError(what, key=key or short(path)) from None


def short(path: Path | str) -> str:
    """A path for an error: one of 5,000 characters would bury the message."""
    text = str(path)
    return text if len(text) <= 200 else f"{text[:100]}...{text[-90:]}"
