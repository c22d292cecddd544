"""A kernel that is not in the cache yet is compiled by one process; the others that need it wait and load it."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
from time import monotonic, sleep
from typing import Any

POLL_SECONDS = 0.05
# Above what any kernel takes on a busy machine; a process that is stopped meanwhile must not stop the others for ever.
PATIENCE_SECONDS = 120.0


class Turns:
    """Stands in for the cache of a compiled function and lets one process at a time fill it.

    The nodes of a run start together and need the same kernels. Without this each compiles all of them, and two that
    save at once can lose an entry of the index. A process that dies lets go of its turn.

    Args:
        cache: numba's own, of a function that is cached on disk.
    """

    def __init__(self, cache: Any) -> None:
        self._cache = cache
        self._path = Path(cache._cache_file._index_path).with_suffix(".lock")
        self._lock: int | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._cache, name)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What is in the cache; where nothing is, this process compiles it next, and no other does."""
        found = self._load(sig, target_context)
        if found is None and self._lock is None:
            self._take()
            found = self._load(sig, target_context)
            if found is not None:
                self._give_back()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Put into the cache what was compiled, and let the others go on."""
        try:
            self._cache.save_overload(sig, data)
        finally:
            self._give_back()

    def _load(self, sig: Any, target_context: Any) -> Any:
        try:
            return self._cache.load_overload(sig, target_context)
        except Exception:
            # Numba reads the types of an entry before it looks at how old it is: a class that has got another name
            # since, or another version of a library, is no reason to fail.
            self._cache.flush()
            return None

    def _take(self) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            lock = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError:
            # What cannot be written is not filled by another process either.
            return
        until = monotonic() + PATIENCE_SECONDS
        while monotonic() < until:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                sleep(POLL_SECONDS)
            else:
                self._lock = lock
                return
        os.close(lock)

    def _give_back(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
