"""A process that another one forked for this one; handled like a ``subprocess.Popen``."""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
from contextlib import suppress

# The code of a process whose parent was gone before it: how it ended is known to none.
NOT_KNOWN = 255


class Status:
    """Where the parent of a process says how it ended.

    Args:
        descriptor: of one end of a pair of sockets.
    """

    def __init__(self, descriptor: int) -> None:
        self._socket = socket.socket(fileno=descriptor)

    def tell(self, code: int) -> None:
        """Say it, once."""
        with self._socket, suppress(OSError):
            self._socket.send(str(code).encode(), socket.MSG_DONTWAIT)


class ForkedProcess:
    """A process that is no child of this one.

    Args:
        pid: of the process.
        status: other end of its ``Status``.

    Attributes:
        returncode: as it was seen last: None while it runs, negative the number of the signal that ended it.
    """

    def __init__(self, pid: int, status: socket.socket) -> None:
        self.pid, self._status = pid, status
        self.returncode: int | None = None
        self._handle: int | None = None
        # It may have ended already. Its number may be another's by the time it is killed; its handle never is.
        with suppress(OSError, AttributeError):
            self._handle = os.pidfd_open(pid)

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        with suppress(subprocess.TimeoutExpired):
            self.wait(0.0)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end; the exit code.

        Raises:
            TimeoutExpired: it did not come within so many seconds.
        """
        if self.returncode is None:
            if not select.select([self._status], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(f"process {self.pid}", timeout or 0.0)
            said = self._status.recv(16)
            if not said and self._handle is not None and not select.select([self._handle], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(f"process {self.pid}", timeout or 0.0)
            self.returncode = int(said or NOT_KNOWN)
            self._close()
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        if self.poll() is not None:
            return
        with suppress(ProcessLookupError):
            if self._handle is None:
                os.kill(self.pid, number)
            else:
                signal.pidfd_send_signal(self._handle, number)

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""
        self.send_signal(signal.SIGKILL)

    def _close(self) -> None:
        self._status.close()
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None
