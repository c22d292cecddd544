"""Replies of a node's services reach their client, also where the client is discovered later than its request."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from time import monotonic
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

# rclpy has no other sign of it than a warning of this text.
TIMED_OUT = "failed to send response (timeout)"
RETRY_SECONDS = 0.25
PATIENCE_SECONDS = 10.0


@dataclass(frozen=True, eq=False, slots=True)
class Reply:
    """A reply whose client cannot hear it yet."""

    send: Callable[[], None]
    service: str
    deadline: float


class Replies:
    """Sends the replies of a node's services until their clients hear them.

    A request and its reply take two topics, which are discovered one by one. Where a node hears a request before it has
    discovered the reader that waits for the reply (the node has just started, the machine is busy, the client has many
    readers), Fast DDS waits 100 ms, warns and drops the reply, and the client waits for ever. Such a reply is kept and
    sent again, for at most ``PATIENCE_SECONDS``.
    """

    def __init__(self) -> None:
        self._waiting: list[Reply] = []

    def start(self, node: Node) -> None:
        """Guard the services that the node has so far; its executor sends again.

        Args:
            node: initialised.
        """
        self._logger = node.get_logger()
        self._timer = node.create_timer(
            RETRY_SECONDS, self.send_again, clock=Clock(clock_type=ClockType.STEADY_TIME), autostart=False
        )
        self.guard(node.services)

    def guard(self, services: Iterable[Any]) -> None:
        """Keep the replies of these services that rclpy would drop.

        Args:
            services: objects of ``rclpy.service.Service``, however they were made; those guarded already stay so.
        """
        for service in services:
            if "send_response" not in vars(service):
                self._guard(service)

    def send_again(self) -> None:
        """Try every reply that waits once more; what waited too long is given up, and the node's log says so."""
        waiting, self._waiting = self._waiting, []
        for reply in waiting:
            if _heard(reply):
                continue
            if monotonic() < reply.deadline:
                self._waiting.append(reply)
            else:
                lasted = f"{PATIENCE_SECONDS:g} s"
                self._logger.warning(f"a client of {reply.service} does not hear its reply after {lasted}")
        if not self._waiting:
            self._timer.cancel()

    @property
    def waiting(self) -> int:
        """How many replies wait for their client."""
        return len(self._waiting)

    def flush(self, seconds: float, hurried: Callable[[], bool] = lambda: False) -> None:
        """Before the node goes: try at most that long [s], or until it is hurried."""
        deadline = monotonic() + seconds
        while self._waiting and monotonic() < deadline and not hurried():
            self.send_again()

    def _guard(self, service: Any) -> None:
        send = service.send_response

        def send_or_keep(response: Any, header: Any) -> None:
            reply = Reply(lambda: send(response, header), service.srv_name, monotonic() + PATIENCE_SECONDS)
            if not _heard(reply):
                self._waiting.append(reply)
                self._timer.reset()

        service.send_response = send_or_keep


def _heard(reply: Reply) -> bool:
    """Send a reply; False where its client is not discovered yet."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            reply.send()
        except InvalidHandle:
            # The service is gone, and with it everybody who waits for it.
            return True
    timed_out = False
    for warning in caught:
        if str(warning.message).startswith(TIMED_OUT):
            timed_out = True
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)
    return not timed_out
