"""What a node that was started by hand waits for, in its log."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from space_robot_msgs_py.nodes.base import GraphNode

# Nodes of a run start one after the other: what comes within this is no news.
LOOK_SECONDS = 2.0


class WaitNotes:
    """Logs, at most every ``LOOK_SECONDS`` and only when it changes, of which topics a node hears no publisher.

    Args:
        node: that waits.
        clock: gives seconds that never go back.
    """

    def __init__(self, node: GraphNode, clock: Callable[[], float] = monotonic) -> None:
        self._node, self._clock, self._said = node, clock, ""
        self._next = clock() + LOOK_SECONDS

    def look(self) -> None:
        """Look, when it is time to."""
        if self._clock() < self._next:
            return
        self._next = self._clock() + LOOK_SECONDS
        missing = ", ".join(self._node.unheard())
        if missing != self._said:
            self._said = missing
            text = f"waiting for a publisher of {missing}" if missing else "hears a publisher of all it waited for"
            self._node.get_logger().info(text)
