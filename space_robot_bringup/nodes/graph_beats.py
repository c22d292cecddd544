"""Heartbeats of nodes of a paced run that were started one by one: on the graph, where each watches the others."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import monotonic

from space_robot_bringup.modes.heartbeats import BEAT_SECONDS, Heartbeats, silence_of
from space_robot_bringup.modes.hooks import SUPERVISOR
from space_robot_msgs_py.codec.codecs import decode_string, encode_string
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.topics import HEARTBEAT

# Without one of them there is no run. A controller may take its time: meanwhile the plant is in its hold.
WATCHED = ("recorder", "guidance", SUPERVISOR, "simulator")


class GraphBeats:
    """Says on ``heartbeat`` that the executor of a node runs, and ends a run of which another node is silent.

    A node that was stopped itself gives the others as long again, see ``Heartbeats``. Before the run has begun nothing
    is missed: who compiles says nothing. A node that is silent cannot be killed from here; when it goes on it misses
    the others, and ends.

    Args:
        node: that says so.
        role: of it in the run.
        clock: steady [s].
    """

    def __init__(self, node: GraphNode, role: str, clock: Callable[[], float] = monotonic) -> None:
        self._node, self._role, self._clock = node, role, clock
        self._last, self._beats = -inf, Heartbeats(clock)
        self._publisher = node.publisher(HEARTBEAT)
        reader = node.listen(HEARTBEAT, self._on_beat)
        if isinstance(node, ManagedNode):
            node.keep_too(self._publisher, reader)

    def look(self) -> None:
        """Call this often."""
        now = self._clock()
        if now - self._last >= BEAT_SECONDS:
            self._last = now
            self._publisher.publish(encode_string(self._role))
        silent = self._beats.silent()
        if silent and self._node.begun and self._node.end_reason is None:
            reason = silence_of(silent[0])
            self._node.get_logger().error(reason)
            self._node.end(reason)

    def _on_beat(self, raw: bytes) -> None:
        try:
            role = decode_string(raw)
        except LayoutError as error:
            self._node.refuse(HEARTBEAT, error)
            return
        if role in WATCHED and role != self._role:
            self._beats.hear(role)
