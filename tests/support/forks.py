"""Processes of a test that start in no time: forks of one process that has everything imported and compiled."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir
from functools import cache
from importlib import import_module
from multiprocessing import forkserver
from multiprocessing.context import ForkServerContext
from pathlib import Path
from time import monotonic, sleep
from typing import Any

ROOT = Path(__file__).parents[2]
PRELOADED = "tests.support.preloaded"
POLL_SECONDS = 0.005


class Fork:
    """A running fork; handled like a ``subprocess.Popen``.

    Args:
        function: what it does, a function of a module.
        arguments: for the function.
        cwd: working directory.
        environment: of the process; None: as it is here.
        session: it leads one of its own, as what a terminal starts; signals reach all that it starts (``os.killpg``).
    """

    def __init__(
        self,
        function: Callable[..., Any],
        *arguments: Any,
        cwd: Path | None = None,
        environment: Mapping[str, str] | None = None,
        session: bool = False,
    ) -> None:
        place = tempfile.mkdtemp(prefix="fork-")
        weakref.finalize(self, shutil.rmtree, place)
        self._said = tuple(Path(place) / name for name in ("stdout", "stderr"))
        given = (self._said, cwd or Path.cwd(), dict(os.environ if environment is None else environment), session)
        self._process = _context().Process(target=_begin, args=(*given, function, arguments))
        self._process.start()
        assert self._process.pid is not None
        self.pid = self._process.pid

    @property
    def returncode(self) -> int | None:
        """As it was seen last: None while it runs, negative the number of the signal that ended it."""
        return self._process.exitcode

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end; the exit code."""
        self._process.join(timeout)
        if self._process.exitcode is None:
            raise subprocess.TimeoutExpired(f"fork {self.pid}", timeout or 0.0)
        return self._process.exitcode

    def await_words(self, words: str, timeout: float) -> None:
        """Wait until it has said something on stderr."""
        deadline = monotonic() + timeout
        while words not in (said := self._said[1].read_text() if self._said[1].exists() else ""):
            assert self.poll() is None, f"ended with {self.returncode}: {said}"
            assert monotonic() < deadline, f"waited {timeout} s for {words!r}, heard {said!r}"
            sleep(POLL_SECONDS)

    def communicate(self, timeout: float | None = None) -> tuple[str, str]:
        """Wait for the end; what it said on stdout and stderr."""
        self.wait(timeout)
        out, err = (path.read_text() if path.exists() else "" for path in self._said)
        return out, err

    def send_signal(self, number: signal.Signals) -> None:
        """Send a signal, unless it has ended."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""
        self.send_signal(signal.SIGKILL)


def fork_main(module: str, *arguments: str, **options: Any) -> Fork:
    """``python -m module arguments``, by the module's ``main``."""
    return Fork(run_main, module, arguments, **options)


def run_main(module: str, arguments: Sequence[str]) -> Any:
    """The ``main`` of a module with these arguments on its command line."""
    sys.argv = [module, *arguments]
    return import_module(module).main()


@cache
def _context() -> ForkServerContext:
    """The process that forks is started once, where it finds the tests, and ends with this one."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([PRELOADED])
    with chdir(ROOT):
        forkserver.ensure_running()
    return context


def _begin(
    said: tuple[Path, Path],
    cwd: Path,
    environment: dict[str, str],
    session: bool,
    function: Callable[..., Any],
    arguments: Any,
) -> None:
    assert PRELOADED in sys.modules, "the process that forks could not import what is to be there already"
    if session:
        os.setsid()
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    for path, stream in zip(said, (sys.stdout, sys.stderr), strict=True):
        with path.open("wb") as file:
            os.dup2(file.fileno(), stream.fileno())
    sys.exit(function(*arguments))
