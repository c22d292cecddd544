"""A process that has everything loaded and forks spawners: where this one has threads, a study starts at once.

It is started with the first study of a process and ends with the process. A spawner that it forks knows nothing of the
studies before: only modules that this project brings are loaded in the nursery itself.
"""

from __future__ import annotations

import atexit
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import import_module
from json import dumps, loads
from multiprocessing.connection import Connection
from typing import Any

from space_robot_msgs_py.errors import SilenceError
from space_robot_studies.engine.pinned import PINNED
from space_robot_studies.engine.serving import serve

PRELOADED = "space_robot_studies.campaign.run_case"
START = (
    "import sys; sys.path[:] = {path!r}; from space_robot_studies.engine.nursery import main; main(int(sys.argv[1]))"
)
# What Python and numba read once, as they are loaded.
READ_ONCE = ("NUMBA_", "PYTHON")
REQUEST_BYTES, END_SECONDS = 1 << 20, 3.0


class Nursery:
    """This process's end of its nursery."""

    def __init__(self) -> None:
        self.read_once, self.owner, self._asking = read_once(os.environ), os.getpid(), threading.Lock()
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            code = START.format(path=sys.path)
            self._process = subprocess.Popen(
                [sys.executable, "-c", code, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env=os.environ | PINNED,
            )

    @property
    def usable(self) -> bool:
        """It is there, belongs to this process, and was started in an environment like the present one."""
        return self.owner == os.getpid() and self._process.poll() is None and self.read_once == read_once(os.environ)

    def fork(self, channel: socket.socket) -> Callable[[], None]:
        """A spawner with the working directory, environment and stderr of this process as they are now.

        Args:
            channel: the spawner's end of its channel.

        Returns:
            What waits for its end, and ends it if it does not come.

        Raises:
            SilenceError: the nursery is gone.
        """
        request = dumps({"cwd": os.getcwd(), "environment": dict(os.environ), "path": sys.path}).encode()
        try:
            # Two threads that ask at once must not get each other's answers.
            with self._asking:
                socket.send_fds(self._socket, [request], [channel.fileno(), 2])
                answer = loads(self._socket.recv(REQUEST_BYTES) or b"null")
        except (OSError, ValueError):
            answer = None
        if answer is None:
            raise SilenceError("the process that starts workers is gone", key="--workers", accepted="--resume")
        return _ended(int(answer))

    @property
    def pid(self) -> int:
        """Of its process."""
        return self._process.pid

    def wait(self) -> None:
        """Wait until it has ended."""
        self._process.wait()

    def close(self) -> None:
        """End it; spawners that it forked end with their own channels."""
        self._socket.close()
        if self.owner == os.getpid():
            self.wait()


_lock = threading.Lock()
_kept: list[Nursery] = []


def nursery() -> Nursery:
    """The nursery of this process, which is started where there is none that can be used."""
    with _lock:
        if _kept and not _kept[0].usable:
            _kept.pop().close()
        if not _kept:
            _kept.append(Nursery())
        return _kept[0]


@atexit.register
def _close_kept() -> None:
    for one in _kept:
        one.close()


def read_once(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that a process which is running already does not read again."""
    return {name: value for name, value in environment.items() if name.startswith(READ_ONCE)}


def _ended(pid: int) -> Callable[[], None]:
    """Waits until a process that is no child of this one is gone; its number may be another's by then."""
    try:
        handle = os.pidfd_open(pid)
    except (OSError, AttributeError):
        return lambda: None

    def end() -> None:
        try:
            if not select.select([handle], [], [], END_SECONDS)[0]:
                signal.pidfd_send_signal(handle, signal.SIGKILL)
                select.select([handle], [], [], END_SECONDS)
        finally:
            os.close(handle)

    return end


def main(descriptor: int) -> None:
    """The nursery itself: fork spawners until the other end is closed."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    # Spawners that have ended leave nothing to be fetched.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with suppress(ImportError):
        import_module(PRELOADED)
    channel = socket.socket(fileno=descriptor)
    while True:
        try:
            request, handles, _, _ = socket.recv_fds(channel, REQUEST_BYTES, 2)
        except OSError:
            return
        if not request:
            return
        pid = os.fork()
        if pid == 0:
            try:
                _become_spawner(channel, loads(request), *handles)
            finally:
                os._exit(0)
        for handle in handles:
            os.close(handle)
        channel.send(dumps(pid).encode())


def _become_spawner(channel: socket.socket, request: dict[str, Any], theirs: int, stderr: int) -> None:
    channel.close()
    os.dup2(stderr, 2)
    os.close(stderr)
    os.chdir(request["cwd"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.path[:] = request["path"]
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    serve(Connection(theirs))
