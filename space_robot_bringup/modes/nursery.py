"""A process that has everything loaded and forks others: what would load it for a second each is there at once.

It is started when it is first needed and ends with this process. What it forks knows nothing of what was forked before:
only modules that this project brings are loaded in the nursery itself, which has one thread and never a ROS context.
"""

from __future__ import annotations

import atexit
import os
import signal
import socket
import subprocess
import sys
import threading
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from fcntl import F_DUPFD, fcntl
from importlib import import_module
from json import dumps, loads
from multiprocessing.connection import wait
from typing import Any, Never

from space_robot_bringup.modes.forked import ForkedProcess, Status
from space_robot_bringup.modes.pinned import PINNED
from space_robot_msgs_py.errors import SilenceError

START = (
    "import sys; sys.path[:] = {path!r}; from space_robot_bringup.modes.nursery import main; "
    "main(int(sys.argv[1]), sys.argv[2])"
)
# What Python, numba, numeric libraries, the linker and ROS read once, as they are loaded.
READ_ONCE = ("NUMBA_", "PYTHON", "LD_", "OMP_", "OPENBLAS_", "MKL_", "ROS_", "RMW_", "FAST", "AMENT_", "RCUTILS_")
# A domain belongs to a run.
OF_A_RUN = ("ROS_DOMAIN_ID",)
REQUEST_BYTES, MAX_DESCRIPTORS = 1 << 20, 64
STDERR = 2


class Nursery:
    """This process's end of its nursery.

    Args:
        preloaded: module that is imported before anything is forked.
    """

    def __init__(self, preloaded: str) -> None:
        self.read_once, self.owner, self._asking = read_once(os.environ), os.getpid(), threading.Lock()
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            code = START.format(path=sys.path)
            self._process = subprocess.Popen(
                [sys.executable, "-c", code, str(theirs.fileno()), preloaded],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=STDERR,
                env=os.environ | PINNED,
            )

    @property
    def usable(self) -> bool:
        """It is there, belongs to this process, and was started in an environment like the present one."""
        return self.owner == os.getpid() and self._process.poll() is None and self.read_once == read_once(os.environ)

    def fork(
        self,
        function: str,
        *arguments: Any,
        descriptors: Sequence[int] = (),
        environment: Mapping[str, str] | None = None,
    ) -> ForkedProcess:
        """A process with the working directory and stderr of this one as they are now; its stdout is its stderr.

        Args:
            function: ``module:function``, called there; the process ends with the code it returns.
            arguments: for the function, of JSON.
            descriptors: open there under the same numbers; no other one of this process is.
            environment: None: as it is here.

        Raises:
            SilenceError: the nursery is gone, or the system has no room for another process.
        """
        place = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))
        status, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        request = {
            "function": function,
            "arguments": arguments,
            "descriptors": list(descriptors),
            "environment": dict(os.environ if environment is None else environment),
            "path": sys.path,
        }
        try:
            with theirs:
                answer = self._ask(dumps(request).encode(), [theirs.fileno(), place, STDERR, *descriptors])
        finally:
            os.close(place)
        if not isinstance(answer, int):
            status.close()
            raise SilenceError(f"no process can be started ({answer or 'what starts them is gone'})")
        return ForkedProcess(answer, status)

    def _ask(self, request: bytes, descriptors: list[int]) -> Any:
        try:
            # Two threads that ask at once must not get each other's answers.
            with self._asking:
                socket.send_fds(self._socket, [request], descriptors)
                return loads(self._socket.recv(REQUEST_BYTES) or b"null")
        except (OSError, ValueError):
            return None

    @property
    def pid(self) -> int:
        """Of its process."""
        return self._process.pid

    def wait(self) -> None:
        """Wait until it has ended."""
        self._process.wait()

    def close(self) -> None:
        """End it; what it forked ends as it sees fit."""
        self._socket.close()
        if self.owner == os.getpid():
            self.wait()


_lock = threading.Lock()
_kept: dict[str, Nursery] = {}


def nursery(preloaded: str) -> Nursery:
    """The nursery of this process that has that module loaded; it is started where there is none that can be used."""
    with _lock:
        if preloaded in _kept and not _kept[preloaded].usable:
            _kept.pop(preloaded).close()
        if preloaded not in _kept:
            _kept[preloaded] = Nursery(preloaded)
        return _kept[preloaded]


@atexit.register
def _close_kept() -> None:
    for one in _kept.values():
        one.close()


def read_once(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that a process which is running already does not read again."""
    return {name: value for name, value in environment.items() if name.startswith(READ_ONCE) and name not in OF_A_RUN}


def main(descriptor: int, preloaded: str) -> Never:
    """The nursery itself: fork until the other end is closed, and say how each process ended."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    wake, alarm = socket.socketpair()
    for end in (wake, alarm):
        end.setblocking(False)
    # With a handler of Python's a signal is written to the pipe.
    signal.set_wakeup_fd(alarm.fileno(), warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    with suppress(ImportError):
        import_module(preloaded)
    channel = socket.socket(fileno=descriptor)
    children: dict[int, Status] = {}
    while True:
        for ready in wait([channel, wake]):
            if ready is wake:
                with suppress(BlockingIOError):
                    wake.recv(4096)
            elif not _obey(channel, children):
                # The interpreter's own end takes half a second, for which the other end would wait.
                os._exit(0)
        _report(children)


def _obey(channel: socket.socket, children: dict[int, Status]) -> bool:
    """Fork what is asked for; False: the other end is closed."""
    try:
        request, handles, _, _ = socket.recv_fds(channel, REQUEST_BYTES, MAX_DESCRIPTORS)
    except OSError:
        return False
    if not request:
        return False
    answer: int | str
    try:
        answer = os.fork()
    except OSError as error:
        answer = str(error.strerror)
    if answer == 0:
        _become(loads(request), handles[1:])
    status, *others = handles
    for handle in others:
        os.close(handle)
    if isinstance(answer, int):
        children[answer] = Status(status)
    else:
        os.close(status)
    channel.send(dumps(answer).encode())
    return True


def _report(children: dict[int, Status]) -> None:
    for pid in list(children):
        done, code = os.waitpid(pid, os.WNOHANG)
        if done:
            children.pop(pid).tell(os.waitstatus_to_exitcode(code))


def _become(request: dict[str, Any], handles: list[int]) -> Never:
    """Be the process that was asked for; never returns. SIGINT and SIGTERM are ignored until it does otherwise."""
    code = 1
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        _take_over(handles, [STDERR, *request["descriptors"]])
        os.environ.clear()
        os.environ.update(request["environment"])
        sys.path[:] = request["path"]
        module, _, name = request["function"].partition(":")
        code = getattr(import_module(module), name)(*request["arguments"]) or 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _take_over(handles: list[int], numbers: list[int]) -> None:
    """The first handle is the working directory, the others get these numbers, and all else is closed.

    A line that another process holds has no end.
    """
    place, *others = handles
    os.fchdir(place)
    aside = [fcntl(handle, F_DUPFD, max(numbers) + 1) for handle in others]
    for name in os.listdir("/proc/self/fd"):
        if int(name) > STDERR and int(name) not in aside:
            with suppress(OSError):
                os.close(int(name))
    for handle, number in zip(aside, numbers, strict=True):
        os.dup2(handle, number)
        os.close(handle)
    os.dup2(STDERR, 1)
    sys.stdout.reconfigure(line_buffering=os.isatty(1))  # type: ignore[union-attr]
