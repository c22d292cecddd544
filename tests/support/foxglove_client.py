"""A client of the WebSocket protocol of Foxglove that knows nothing of this project, nor of the Foxglove SDK."""

from __future__ import annotations

import json
from collections.abc import Callable
from struct import Struct
from typing import Any

from websockets.sync.client import connect
from websockets.typing import Subprotocol

PROTOCOL = "foxglove.sdk.v1"
DATA, ASSET = 1, 4
_HEAD = Struct("<BIQ")
SECONDS = 60.0


class FoxgloveClient:
    """Subscribes to every channel.

    Args:
        address: of the server.

    Attributes:
        channels: by topic, as advertised.
        messages: topic, time [ns] and bytes, in the order in which they came.
        capabilities: of the server.
    """

    def __init__(self, address: str) -> None:
        self._socket = connect(address, subprotocols=[Subprotocol(PROTOCOL)], max_size=None, open_timeout=SECONDS)
        assert self._socket.subprotocol == PROTOCOL
        self.capabilities: list[str] = json.loads(self._socket.recv(SECONDS))["capabilities"]
        found = json.loads(self._socket.recv(SECONDS))
        assert found["op"] == "advertise"
        self.channels: dict[str, dict[str, Any]] = {one["topic"]: one for one in found["channels"]}
        self._topics = {one["id"]: one["topic"] for one in found["channels"]}
        self.messages: list[tuple[str, int, bytes]] = []
        wanted = [{"id": number, "channelId": number} for number in self._topics]
        self.send({"op": "subscribe", "subscriptions": wanted})

    def send(self, request: dict[str, Any]) -> None:
        """Send a request of the protocol."""
        self._socket.send(json.dumps(request))

    def receive(self) -> bytes | str:
        """The next answer; a message of a channel is kept in ``messages``, too."""
        found = self._socket.recv(SECONDS)
        if isinstance(found, bytes) and found[0] == DATA:
            _, number, stamp = _HEAD.unpack_from(found)
            self.messages.append((self._topics[number], stamp, found[_HEAD.size :]))
        return found

    def receive_until(self, holds: Callable[[], object]) -> None:
        """Until something holds."""
        while not holds():
            self.receive()

    def close(self) -> None:
        """Leave."""
        self._socket.close()
