"""A process that has everything loaded and forks others: what would load it for a second each is there at once.

It is started when it is first needed and ends with this process. What it forks knows nothing of what was forked before:
only modules that this project brings are loaded in the nursery itself, which has one thread and never a ROS context.
"""

from __future__ import annotations

import atexit
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from json import dumps, loads
from typing import Any

from space_robot_bringup.modes.forked import ForkedProcess
from space_robot_bringup.modes.nursery_process import REQUEST_BYTES, STDERR
from space_robot_bringup.modes.pinned import PINNED
from space_robot_msgs_py.errors import SilenceError

START = (
    "import sys; sys.path[:] = {path!r}; from space_robot_bringup.modes.nursery_process import main; "
    "main(int(sys.argv[1]), sys.argv[2])"
)
# What Python, numba, numeric libraries, the linker and ROS read once, as they are loaded.
READ_ONCE = ("NUMBA_", "PYTHON", "LD_", "OMP_", "OPENBLAS_", "MKL_", "ROS_", "RMW_", "FAST", "AMENT_", "RCUTILS_")
# A domain belongs to a run.
OF_A_RUN = ("ROS_DOMAIN_ID",)


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
        alive = self._socket.fileno() >= 0 and self.owner == os.getpid() and self._process.poll() is None
        return alive and self.read_once == read_once(os.environ)

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
        status, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        place = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))
        request = {
            "function": function,
            "arguments": arguments,
            "descriptors": list(descriptors),
            "environment": dict(os.environ if environment is None else environment),
            "path": sys.path,
        }
        try:
            with theirs:
                answer = self._ask(request, [theirs.fileno(), place, STDERR, *descriptors])
        finally:
            os.close(place)
        if not isinstance(answer, int):
            status.close()
            raise SilenceError(f"no process can be started ({answer or 'what starts them is gone'})")
        return ForkedProcess(answer, status)

    def prepare(self, function: str, descriptor: int) -> None:
        """Call a function in the nursery itself: what it loads is there in all that is forked from now on.

        Args:
            function: ``module:function``, called with a descriptor; what it raises is left to the processes to say.
            descriptor: of a file.
        """
        self._ask({"prepare": function}, [descriptor])

    def _ask(self, request: dict[str, Any], descriptors: list[int]) -> Any:
        try:
            # Two threads that ask at once must not get each other's answers.
            with self._asking:
                socket.send_fds(self._socket, [dumps(request).encode()], descriptors)
                return loads(self._socket.recv(REQUEST_BYTES) or b"null")
        except (OSError, ValueError):
            return None
        except BaseException:
            # Of a signal: the answer that still comes must not be taken for another one's.
            self._socket.close()
            raise

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
