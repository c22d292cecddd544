"""The nursery itself: forks what it is asked for, until the other end of its channel is closed."""

from __future__ import annotations

import os
import signal
import socket
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from fcntl import F_DUPFD, fcntl
from importlib import import_module
from json import dumps, loads
from multiprocessing.connection import wait
from typing import Any, Never

from space_robot_bringup.modes.forked import Status

REQUEST_BYTES, MAX_DESCRIPTORS = 1 << 20, 64
STDERR = 2


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
    """Do what is asked for and answer; False: the other end is closed."""
    try:
        text, handles, _, _ = socket.recv_fds(channel, REQUEST_BYTES, MAX_DESCRIPTORS)
    except OSError:
        return False
    if not text:
        return False
    request = loads(text)
    answer = _prepared(request["prepare"], *handles) if "prepare" in request else _fork(request, handles, children)
    channel.send(dumps(answer).encode())
    return True


def _prepared(function: str, descriptor: int) -> int:
    with suppress(Exception):
        _named(function)(descriptor)
    os.close(descriptor)
    return 0


def _fork(request: dict[str, Any], handles: list[int], children: dict[int, Status]) -> int | str:
    """The number of a new process, or why there is none."""
    status, *others = handles
    try:
        pid = os.fork()
    except OSError as error:
        os.close(status)
        return str(error.strerror)
    else:
        if pid == 0:
            _become(request, others)
        children[pid] = Status(status)
        return pid
    finally:
        for handle in others:
            os.close(handle)


def _named(function: str) -> Callable[..., Any]:
    module, _, name = function.partition(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


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
        code = _named(request["function"])(*request["arguments"]) or 0
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
