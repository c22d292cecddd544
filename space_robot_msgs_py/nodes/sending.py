"""The short way of ready bytes to the middleware."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rclpy.publisher import Publisher

# Sends the bytes of a message.
Send = Callable[[bytes], None]


def sending(publisher: Publisher) -> Send:
    """What sends ready bytes on a publisher, without the checks of ``publish``, which take a third of its time."""
    send: Send = publisher.handle.publish_raw
    return send


def publish_all(senders: Sequence[Send], parts: Sequence[bytes]) -> None:
    """Publish the parts of one value, each on its topic."""
    for send, part in zip(senders, parts, strict=True):
        send(part)
