"""Node processes of a run that start in no time: forks of the process that starts them, which has all they need."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Any
from unittest.mock import patch

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes import processes
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.nodes import process

POLL = 0.005


class ForkedNode:
    """As much of ``subprocess.Popen`` as a run needs; the kernel knows the process by its role."""

    def __init__(self, command: Sequence[str], *, env: dict[str, str], pass_fds: Sequence[int], **_: Any) -> None:
        self.returncode: int | None = None
        self.pid = os.fork()
        if not self.pid:
            _be(command[command.index("space_robot_bringup.nodes.process") + 1 :], env, pass_fds)

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        if self.returncode is None:
            with suppress(ChildProcessError):
                pid, status = os.waitpid(self.pid, os.WNOHANG)
                self.returncode = os.waitstatus_to_exitcode(status) if pid else None
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """The exit code, once it has ended."""
        end = float("inf") if timeout is None else monotonic() + timeout
        while self.poll() is None:
            if monotonic() > end:
                raise subprocess.TimeoutExpired("node", timeout or 0.0)
            sleep(POLL)
        assert self.returncode is not None
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""
        self.send_signal(signal.SIGKILL)


def _be(arguments: Sequence[str], environment: dict[str, str], kept: Sequence[int]) -> None:
    """What a new process would be: a line that another process holds has no end."""
    try:
        os.setsid()
        Path("/proc/self/comm").write_text(arguments[0])
        for name in os.listdir("/proc/self/fd"):
            if int(name) > 2 and int(name) not in kept:
                with suppress(OSError):
                    os.close(int(name))
        os.dup2(2, 1)
        os.environ.clear()
        os.environ.update(environment)
        process.leave(process.main(list(arguments)))
    finally:
        os._exit(70)


def run_forked(
    place: Path, experiment: str, overrides: Sequence[str], on_tick: Callable[[int], None], **options: Any
) -> str:
    """``run_processes`` with forks of this process as nodes; ``space_robot_bringup`` is loaded and compiled."""
    composition = compose(load_experiment(experiment, overrides))
    with patch.object(processes.subprocess, "Popen", ForkedNode):
        return processes.run_processes(composition, place, hooks=Hooks(on_tick), **options)


def nodes_of(parent: int) -> dict[str, int]:
    """Process ids of the nodes that a process has forked, by role."""
    found = {}
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError, IndexError):
            name, status = (entry / "stat").read_text().partition("(")[2].rpartition(")")[::2]
            if int(status.split()[1]) == parent:
                found[name] = int(entry.name)
    return found
