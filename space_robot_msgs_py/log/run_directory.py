"""A run directory that one run at a time writes to: made, locked, and reached by its descriptor from then on."""

from __future__ import annotations

import fcntl
import os
import weakref
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO

from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.directory import BAG_SUFFIX, METADATA_FILE, TEMPORARY
from space_robot_msgs_py.log.preamble import signature

GONE = "it was deleted, moved or replaced in the course of the run"


class RunDirectory:
    """A locked run directory.

    The lock ends with the process, however it ends. A child process that inherits the descriptor holds the same lock.

    Args:
        directory: it is made where it is not there; one that nothing was written to is removed again at the end.
        inherited: its descriptor, opened and locked by the parent process.

    Attributes:
        path: of the directory.
        bag: path of the bag file in it.
        descriptor: of the open directory.

    Raises:
        LogError: another run writes here, or it cannot be made.
    """

    def __init__(self, directory: Path, *, inherited: int | None = None) -> None:
        try:
            self.path = directory.resolve()
            if not self.path.name:
                raise LogError("a run directory needs a name", key=str(directory))
            self.bag = self.path / f"{self.path.name}{BAG_SUFFIX}"
            self._made = inherited is None and _make(self.path)
            self.descriptor = _open_locked(self.path) if inherited is None else inherited
        except LogError:
            raise
        except (OSError, RuntimeError, ValueError) as error:
            # Before Python 3.13 a loop of links is a RuntimeError; a null byte in a name is a ValueError.
            reason = getattr(error, "strerror", None) or str(error)
            raise LogError(f"no run directory can be made here: {reason}", key=short(directory)) from None
        os.set_inheritable(self.descriptor, False)
        self._close = weakref.finalize(self, os.close, self.descriptor)

    def __enter__(self) -> RunDirectory:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let another run write here; later calls do nothing."""
        if not self._close.alive:
            return
        with suppress(OSError):
            if self._made and not os.listdir(self.descriptor) and self.holds_path():
                self.path.rmdir()
        with suppress(OSError):
            # Explicitly: a process that was forked meanwhile holds the descriptor, too.
            fcntl.flock(self.descriptor, fcntl.LOCK_UN)
        self._close()

    def clear(self) -> None:
        """Remove a previous run of this project from it.

        Raises:
            LogError: something else is in it.
        """
        try:
            names = sorted(os.listdir(self.descriptor))
            bags = [name for name in names if name.endswith(BAG_SUFFIX)]
            if names and not (bags and all(map(self._is_ours, bags))):
                raise LogError(
                    "not empty and not a run directory", key=str(self.path), accepted="a new or empty directory"
                )
            # The description goes first: a kill in between must not leave one that describes another bag.
            for name in (METADATA_FILE, METADATA_FILE + TEMPORARY, *(bag + TEMPORARY for bag in bags), *bags):
                self.remove(name)
        except LogError:
            raise
        except OSError as error:
            raise LogError(f"cannot be emptied: {error.strerror or error}", key=str(self.path)) from None

    def create(self, name: str, *, buffering: int = -1) -> IO[bytes]:
        """A new file in it, to be written and read; one of that name is replaced, and no link is followed."""
        self.remove(name)
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL
        descriptor = os.open(name, flags, 0o666, dir_fd=self.descriptor)
        stream: IO[bytes] = os.fdopen(descriptor, "w+b", buffering=buffering)
        return stream

    def open(self, name: str) -> IO[bytes]:
        """A file that is in it, to be read and written."""
        return os.fdopen(os.open(name, os.O_RDWR | os.O_NOFOLLOW, dir_fd=self.descriptor), "r+b")

    def replace(self, source: str, target: str) -> None:
        """Give a file of it the name of another, which is replaced at once."""
        os.replace(source, target, src_dir_fd=self.descriptor, dst_dir_fd=self.descriptor)

    def remove(self, name: str) -> None:
        """Remove a file from it, if it is there."""
        with suppress(FileNotFoundError):
            os.unlink(name, dir_fd=self.descriptor)

    def holds_path(self) -> bool:
        """True while its path still leads to it."""
        return _identity(self.path) == _identity(self.descriptor)

    def _is_ours(self, name: str) -> bool:
        """Began by this project; also an empty file, which is what a kill right after opening leaves."""
        expected = signature()
        with os.fdopen(os.open(name, os.O_RDONLY, dir_fd=self.descriptor), "rb") as stream:
            return expected.startswith(stream.read(len(expected)))


class WatchedFile:
    """A file that is written, and whether its path still leads to it: what is deleted takes all that is written.

    Args:
        path: of the file.
        stream: the open file.
    """

    def __init__(self, path: Path, stream: IO[bytes]) -> None:
        self._path, self._identity = os.fspath(path), _identity(stream.fileno())

    def check(self) -> None:
        """Raise an OSError if the path no longer leads to the file."""
        if _identity(self._path) != self._identity:
            raise FileNotFoundError(0, GONE)


def _identity(place: str | Path | int) -> tuple[int, int] | None:
    """Device and inode; None where there is nothing."""
    try:
        found = os.stat(place)
    except (FileNotFoundError, NotADirectoryError):
        return None
    return found.st_dev, found.st_ino


def _make(path: Path) -> bool:
    """Make the directory; False if it was there."""
    if path.exists() and not path.is_dir():
        raise LogError("this is a file", key=str(path), accepted="a directory, new, empty or of an earlier run")
    try:
        path.mkdir(parents=True)
    except FileExistsError:
        return False
    return True


def _open_locked(path: Path) -> int:
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise LogError("another run is writing here", key=str(path), accepted="another directory") from None
    except OSError:
        # A file system without locks: the run goes on as it would have without asking.
        pass
    return descriptor
