"""The line between the process that started a run and each of its nodes: orders one way, news the other.

It is a pair of sockets of its own, which keep packets whole: what a law or the middleware prints on stdout is not taken
for a message. Its end is news, too: the operating system closes it when a process dies, whatever it dies of.
"""

from __future__ import annotations

import json
import os
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Any

from space_robot_bringup.ends import of_process

PARENT_DIED = of_process("parent", "ended")
DEATH = json.dumps({"end": PARENT_DIED, "hurry": True}).encode()
MAX_PACKET, MAX_TEXT = 1 << 16, 1000
# A child that was ordered to end and does not get there is stuck in a law; nothing waits for it any longer.
CHILD_GRACE_SECONDS = 1.5
CLOSING_SECONDS = 60.0


class ParentEnd:
    """The end of a tether in the process that starts the nodes.

    Attributes:
        child: the other end, to be handed to the child and closed here.
    """

    def __init__(self) -> None:
        self._socket, self.child = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.setblocking(False)

    def fileno(self) -> int:
        """For selectors."""
        return self._socket.fileno()

    def order_end(self, reason: str, *, hurry: bool) -> None:
        """Tell the child to end; in a hurry it does not wait until all it has said is acknowledged."""
        # Where it is gone, the end of the line tells.
        with suppress(OSError):
            self._socket.send(_packet({"end": reason, "hurry": hurry}))

    def news(self) -> dict[str, Any] | None:
        """What the child has said next; None: it is gone."""
        try:
            packet = self._socket.recv(MAX_PACKET)
        except BlockingIOError:
            return {}
        except OSError:
            return None
        return _message(packet) if packet else None

    def close(self) -> None:
        """Let go of it; a child that is still there ends."""
        self._socket.close()


class ChildEnd:
    """The end of a tether in a node's process.

    Args:
        descriptor: inherited from the parent; None: there is none, and nothing is sent.
        on_order: called with the reason to end, by a thread: what the parent says, or that it died.

    Attributes:
        grace: how long the process may take to end once it was ordered to [s].
        hurry: there is nothing to wait for: a process of the run died, or the log is closed.
        bereaved: a process of the run died before this one was to end.
    """

    def __init__(self, descriptor: int | None, on_order: Callable[[str], None]) -> None:
        self._on_order, self.grace = on_order, CHILD_GRACE_SECONDS
        self.hurry = self.bereaved = False
        self._socket = None if descriptor is None else socket.socket(fileno=descriptor)
        if self._socket is not None:
            # What this process starts itself must not hold the line.
            self._socket.set_inheritable(False)
            threading.Thread(target=self._listen, args=(self._socket,), daemon=True).start()

    def tell(self, **news: Any) -> None:
        """Tell the parent; one that is gone, or does not read, misses nothing it needs."""
        if self._socket is not None:
            with suppress(OSError):
                self._socket.send(_packet(news), socket.MSG_DONTWAIT)

    def _listen(self, line: socket.socket) -> None:
        order = self._next_order(line)
        self.bereaved = self.hurry
        self._on_order(str(order["end"]))
        until = monotonic() + self.grace
        while not self.hurry:
            self._next_order(line)
        # A process that ends takes this thread along.
        threading.Event().wait(until - monotonic())
        os._exit(1)

    def _next_order(self, line: socket.socket) -> dict[str, Any]:
        try:
            order = _message(line.recv(MAX_PACKET) or DEATH)
        except OSError:
            order = _message(DEATH)
        self.hurry = bool(order["hurry"])
        return order


def _packet(message: dict[str, Any]) -> bytes:
    packet = json.dumps(message).encode()
    if len(packet) > MAX_PACKET:
        packet = json.dumps({key: str(value)[:MAX_TEXT] for key, value in message.items()}).encode()
    return packet


def _message(packet: bytes) -> dict[str, Any]:
    message: dict[str, Any] = json.loads(packet)
    return message
