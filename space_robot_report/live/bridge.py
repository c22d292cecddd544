"""A run for Foxglove over WebSocket, as its log has it; the only importer of the Foxglove SDK."""

from __future__ import annotations

from typing import Any

import foxglove

from space_robot_description.share import mesh_file
from space_robot_msgs_py.codec.codecs import encode_string
from space_robot_msgs_py.codec.schemas import schema_text
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import MESH_BYTES
from space_robot_msgs_py.log.preamble import ALWAYS, RECORDED, log_name
from space_robot_msgs_py.topics import ROBOT_DESCRIPTION, TF_STATIC, Topic
from space_robot_report.live.brief import Brief
from space_robot_report.live.feed import Feed

HOST = "127.0.0.1"


class FoxgloveBridge:
    """Serves the messages of a run on this host only, with the subprotocol ``foxglove.sdk.v1``.

    Clients can look and nothing else: it offers neither parameters nor services, and takes no messages. The robot's
    description and the still frames are sent again to every client that subscribes. Of the files of this machine it
    gives out the robot's meshes, as the viewer does.

    Args:
        brief: of the run.
        static: the message on ``/tf_static``; None where there is none.

    Raises:
        SpecError: the port is taken.
    """

    def __init__(self, brief: Brief, static: bytes | None) -> None:
        # Kept: its channels are closed with it.
        self._context = context = foxglove.Context()
        self._channels = {topic: _channel(topic, context) for topic in RECORDED if _is_there(topic, brief)}
        latched = {ROBOT_DESCRIPTION: encode_string(brief.urdf), TF_STATIC: static}
        self._latched = {topic: data for topic, data in latched.items() if data is not None}
        try:
            self._server = foxglove.start_server(
                name=brief.title,
                host=HOST,
                port=brief.foxglove,
                context=context,
                server_listener=_Latch(self._say_latched),
                asset_handler=_Meshes(brief),
            )
        except (OSError, RuntimeError, ValueError) as error:
            accepted = "a port of this machine that is free"
            raise SpecError(
                f"cannot listen: {error}", key="--foxglove", value=brief.foxglove, accepted=accepted
            ) from None

    @property
    def address(self) -> str:
        """What Foxglove opens."""
        return f"ws://{HOST}:{self._server.port}"

    def say(self, topic: Topic, stamp: int, data: bytes) -> None:
        """Send a message to those who subscribed to its topic, with its stamp [ns] as its time, as in the log."""
        self._channels[topic].log(data, log_time=stamp)

    def draw(self, feed: Feed) -> None:
        """Everything was sent already."""

    def close(self) -> None:
        """Disconnect all."""
        self._server.stop()

    def _say_latched(self, name: str) -> None:
        for topic, data in self._latched.items():
            if log_name(topic) == name:
                self.say(topic, 0, data)


class _Latch(foxglove.websocket.ServerListener):
    """Who subscribes late gets what was said before."""

    def __init__(self, say: Any) -> None:
        self._say = say

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """A client begins to listen."""
        del client
        self._say(channel.topic)


class _Meshes:
    """Reads the meshes of the robot, and no other file."""

    def __init__(self, brief: Brief) -> None:
        self._urdf, self._folders = brief.urdf, brief.folders

    def __call__(self, uri: str) -> bytes | None:
        path = mesh_file(uri, self._folders) if f'"{uri}"' in self._urdf else None
        return path.read_bytes() if path is not None and path.stat().st_size <= MESH_BYTES.most else None


def _is_there(topic: Topic, brief: Brief) -> bool:
    return topic.name in ALWAYS or topic in brief.optional


def _channel(topic: Topic, context: Any) -> Any:
    schema = foxglove.Schema(name=topic.type, encoding="ros2msg", data=schema_text(topic.type).encode())
    return foxglove.Channel(log_name(topic), schema=schema, message_encoding="cdr", context=context)
