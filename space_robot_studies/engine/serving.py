"""What a spawner does: fork workers on its parent's word, and say how they ended."""

from __future__ import annotations

import os
import signal
import socket
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import recv_handle
from typing import Any

from space_robot_studies.engine.worker import settle, work


def serve(channel: Connection) -> None:
    """Start and end workers on the parent's word; end with all of them when the parent closes its end, or dies."""
    settle()
    wake, alarm = socket.socketpair()
    for end in (wake, alarm):
        end.setblocking(False)
    signal.set_wakeup_fd(alarm.fileno(), warn_on_full_buffer=False)
    # With a handler of Python's a signal is written to the pipe.
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    children: set[int] = set()
    try:
        while True:
            for ready in wait([channel, wake]):
                if ready is channel:
                    _obey(channel.recv(), channel, children, (wake, alarm))
                else:
                    with suppress(BlockingIOError):
                        wake.recv(4096)
            _report(channel, children)
    except (EOFError, OSError):
        return
    finally:
        for pid in children:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)


def serve_on(descriptor: int) -> None:
    """``serve`` in a process that a nursery forked, which has the channel under this number."""
    serve(Connection(descriptor))


def _obey(
    message: tuple[Any, ...], channel: Connection, children: set[int], signals: tuple[socket.socket, ...]
) -> None:
    match message:
        case ("prepare", function, arguments):
            with suppress(BaseException):
                function(*arguments)
            channel.send(("prepared", 0))
        case ("start",):
            channel.send(_start(recv_handle(channel), channel, children, signals))
        case ("kill", pid) if pid in children:
            os.kill(pid, signal.SIGKILL)


def _start(
    descriptor: int, channel: Connection, children: set[int], signals: tuple[socket.socket, ...]
) -> tuple[str, int | str]:
    try:
        pid = os.fork()
    except OSError as error:
        return "refused", str(error.strerror)
    else:
        if pid == 0:
            _become_worker(descriptor, channel, signals)
        children.add(pid)
        return "started", pid
    finally:
        os.close(descriptor)


def _become_worker(descriptor: int, channel: Connection, signals: tuple[socket.socket, ...]) -> None:
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        channel.close()
        for end in signals:
            end.close()
        work(Connection(descriptor))
        os._exit(0)
    finally:
        os._exit(1)


def _report(channel: Connection, children: set[int]) -> None:
    """Say which workers have ended."""
    for pid in list(children):
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            children.discard(pid)
            channel.send(("ended", pid, os.waitstatus_to_exitcode(status)))
