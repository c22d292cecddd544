"""The spawner: a process with one thread that forks workers and says how they ended.

Forking a process with several threads may copy a lock that is never released. The spawner never has a second thread, so
that a worker is there within milliseconds at any time, with everything loaded that the spawner has loaded.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import send_handle
from typing import Any

from space_robot_bringup.modes.nursery import nursery
from space_robot_msgs_py.errors import SilenceError
from space_robot_studies.engine.serving import serve

# What the nursery of studies has loaded.
PRELOADED = "space_robot_studies.campaign.run_case"
END_SECONDS = 3.0
POLL_SECONDS = 0.2


class WorkerProcess:
    """One worker.

    Attributes:
        pid: of the process.
        connection: tasks go in, results come out; at its end when the process has ended.
    """

    def __init__(self, pid: int, connection: Connection) -> None:
        self.pid, self.connection = pid, connection


class Spawner:
    """The parent's end of a spawner; it has to be closed.

    A process with one thread forks it, which takes milliseconds and keeps what is loaded; otherwise the nursery does,
    whose own start, with the first study of a process, takes about two seconds.
    """

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        self._end = _fork(ours, theirs) if _single_threaded() else _fork_from_nursery(theirs)
        theirs.close()
        self._socket, self._channel = ours, Connection(os.dup(ours.fileno()))
        self._ended: dict[int, int] = {}

    def prepare(self, function: Callable[..., object], arguments: tuple[Any, ...], stop: Callable[[], object]) -> None:
        """Call a function in the spawner, so that what it loads or compiles is there in every worker.

        Args:
            function: of a module; what it raises is left to the runs to report.
            arguments: picklable.
            stop: asked meanwhile; a reason ends the wait.
        """
        self._send(("prepare", function, arguments))
        while not wait([self._channel], POLL_SECONDS):
            if stop() is not None:
                return
        self._receive("prepared")

    def start(self) -> WorkerProcess:
        """A new worker.

        Raises:
            SilenceError: the system has no room for another process, or the spawner is gone.
        """
        ours, theirs = socket.socketpair()
        with ours, theirs:
            self._send(("start",))
            try:
                send_handle(self._channel, theirs.fileno(), None)
            except OSError:
                raise _gone() from None
            pid = self._receive("started")
            self._ended.pop(pid, None)
            return WorkerProcess(pid, Connection(os.dup(ours.fileno())))

    def kill(self, worker: WorkerProcess) -> None:
        """End a worker at once; only the spawner does, because it knows which processes are still its own."""
        worker.connection.close()
        if worker.pid not in self._ended:
            with suppress(SilenceError):
                self._send(("kill", worker.pid))

    def exit_code(self, worker: WorkerProcess) -> int | None:
        """How a worker ended whose connection is at its end: a status, or minus a signal; None: not known."""
        while worker.pid not in self._ended:
            if not wait([self._channel], END_SECONDS):
                return None
            self._note(self._next())
        return self._ended[worker.pid]

    def close(self) -> None:
        """End the workers and the spawner; nothing is left on return."""
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_WR)
        with suppress(SilenceError):
            while wait([self._channel], END_SECONDS):
                self._next()
        self._channel.close()
        self._socket.close()
        self._end()

    def _send(self, message: tuple[Any, ...]) -> None:
        try:
            self._channel.send(message)
        except OSError:
            raise _gone() from None

    def _receive(self, word: str) -> int:
        while (message := self._next())[0] != word:
            if message[0] == "refused":
                raise SilenceError(f"no worker process can be started ({message[1]})", key="--workers")
            self._note(message)
        return int(message[1])

    def _note(self, message: tuple[Any, ...]) -> None:
        if message[0] == "ended":
            self._ended[message[1]] = message[2]

    def _next(self) -> tuple[Any, ...]:
        try:
            message: tuple[Any, ...] = self._channel.recv()
        except (EOFError, OSError):
            raise _gone() from None
        return message


def _gone() -> SilenceError:
    return SilenceError("the process that starts workers is gone", key="--workers", accepted="--resume")


def _single_threaded() -> bool:
    """Whether this process is known to have one thread, those of libraries counted."""
    try:
        return len(os.listdir("/proc/self/task")) == 1
    except OSError:
        return False


def _fork(ours: socket.socket, theirs: socket.socket) -> Callable[[], None]:
    # Else what is buffered would be written twice.
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid == 0:
        try:
            ours.close()
            serve(Connection(theirs.detach()))
        finally:
            os._exit(0)

    def end() -> None:
        with suppress(ChildProcessError, ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)

    return end


def _fork_from_nursery(theirs: socket.socket) -> Callable[[], None]:
    number = theirs.fileno()
    try:
        process = nursery(PRELOADED).fork(f"{serve.__module__}:serve_on", number, descriptors=[number])
    except SilenceError:
        raise _gone() from None

    def end() -> None:
        try:
            process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(END_SECONDS)

    return end
