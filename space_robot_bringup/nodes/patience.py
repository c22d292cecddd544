"""How long a node waits for a run: one that never begins, or is over, is no reason to stay for ever."""

from __future__ import annotations

from time import monotonic

from space_robot_msgs_py.errors import SilenceError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic


class Patience:
    """Ends a node that listens to a topic which nothing publishes.

    A run that is paused has its simulator, and is waited for. A simulator that was killed is missed some 20 s later,
    when the middleware gives it up.

    Args:
        node: that waits.
        topic: it waits for.
        seconds: it waits; infinity: for ever.
    """

    def __init__(self, node: GraphNode, topic: Topic, seconds: float) -> None:
        self._node, self._topic, self._seconds = node, topic, seconds
        self._since = monotonic()

    def look(self) -> None:
        """Call this often."""
        now = monotonic()
        if self._node.publisher_count(self._topic) != 0:
            self._since = now
        elif now - self._since > self._seconds and self._node.end_reason is None:
            error = SilenceError(
                "nothing publishes it; the run is over or never began",
                key=self._topic.name,
                value=f"{self._seconds:g} s of silence",
                accepted=f"a simulator on this domain within {self._seconds:g} s (patience)",
            )
            self._node.fail(error)
