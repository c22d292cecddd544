"""Other processes of a test: followed through the log that grows, and none left behind."""

from __future__ import annotations

import contextlib
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import monotonic
from typing import TypeVar

from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.log_reader import LogReader
from tests.integration.forks import Fork

Child = TypeVar("Child", subprocess.Popen[str], Fork)
POLL_SECONDS = 0.2


@contextlib.contextmanager
def ended(children: Sequence[Child]) -> Iterator[Sequence[Child]]:
    """Whatever happens in the block, none of them outlives it."""
    try:
        yield children
    finally:
        for child in children:
            if child.poll() is None:
                child.kill()
                child.wait()


def ticks_in(run: Path) -> int:
    """Complete ticks in a log; 0 where there is none yet."""
    with contextlib.suppress(InputFileError, LogError):
        return sum(1 for _ in LogReader(run).ticks())
    return 0


def await_ticks(run: Path, count: int, child: subprocess.Popen[str] | Fork, seconds: float) -> None:
    """Wait until the log holds so many ticks; the child whose run it is must go on."""
    deadline = monotonic() + seconds
    while (seen := ticks_in(run)) < count:
        assert monotonic() < deadline, f"waited {seconds} s for {count} ticks in {run}, saw {seen}"
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(POLL_SECONDS)
            raise AssertionError(f"ended with {child.returncode} after {seen} ticks: {child.communicate()[0]}")
