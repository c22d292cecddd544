"""Other processes of a test: followed through the log that grows, and none left behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import monotonic
from typing import TypeVar

from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.log.reader import LogReader
from tests.support.forks import Fork

Child = TypeVar("Child", subprocess.Popen[str], Fork)
POLL_SECONDS = 0.2
# For what ends by itself: only a fault comes near it, however busy the machine is and whatever has to be compiled.
DEADLINE = 180.0

Spawn = Callable[..., "subprocess.Popen[str]"]


def end(child: subprocess.Popen[str] | Fork) -> None:
    """Leave nothing of a process: it is killed, with its session where it leads one, and its pipes are closed."""
    if child.poll() is None:
        # It may have ended just now.
        with contextlib.suppress(ProcessLookupError):
            if os.getpgid(child.pid) == child.pid:
                os.killpg(child.pid, signal.SIGKILL)
        child.kill()
        child.wait()
    for pipe in (child.stdin, child.stdout, child.stderr) if isinstance(child, subprocess.Popen) else ():
        if pipe is not None:
            pipe.close()


@contextlib.contextmanager
def ended(children: Sequence[Child]) -> Iterator[Sequence[Child]]:
    """Whatever happens in the block, none of them outlives it, nor do their pipes."""
    try:
        yield children
    finally:
        for child in children:
            end(child)


def said_by(children: Sequence[Child], seconds: float = DEADLINE) -> list[str]:
    """What the processes said on stdout and stderr until they ended, each within so many seconds."""
    return ["".join(filter(None, child.communicate(timeout=seconds))) for child in children]


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
            raise AssertionError(f"ended with {child.returncode} after {seen} ticks: {child.communicate()}")
