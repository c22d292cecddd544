"""Who is there: every publisher that a run needs, before it starts, and who publishes, until it ends."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.subscription import Subscription
from rclpy.time import Time

from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic, topics_of
from space_robot_sim.nodes.publishers import Publishers

ROLL_CALL_SECONDS = 0.02
GRACE_SECONDS = 1.0
WATCH_SECONDS = 1.0
# What is late in a paced run is waited for so long, longer than a link is down; less where nothing would send it.
PATIENCE_SECONDS, PATIENCE_ALONE_SECONDS = 15.0, 3.0
# Kinds without which a run may start: a third-party controller may have no telemetry, and a clock waits for none.
DISPENSABLE = frozenset(("controller_telemetry",))
DISPENSABLE_PACED = DISPENSABLE | {"command", "reference"}


class Attendance:
    """Calls the roll until the run may start, and watches who publishes for as long as the node lives.

    The run may start when every required topic has a publisher; those that it can do without get ``GRACE_SECONDS``.

    Args:
        node: that listens; its executor runs the timers.
        readers: subscription of every topic that is recorded.
        required: topics that a complete tick has.
        lossless: what is not there at the start will not come (lock-step).
        on_start: called once, with the topics that are absent.
        on_watch: called often, in lock-step once a second.
    """

    def __init__(
        self,
        node: GraphNode,
        readers: Mapping[Topic, Subscription],
        required: frozenset[Topic],
        *,
        lossless: bool,
        on_start: Callable[[frozenset[Topic]], None],
        on_watch: Callable[[], None],
    ) -> None:
        self._node, self._lossless = node, lossless
        self._on_start, self._on_watch = on_start, on_watch
        self._required, self._readers = required, readers
        # The name of a node of another project that commands is to be in the log.
        self._publishers = Publishers(node, readers, {topic: topic.publisher for topic in topics_of("command")})
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._present_since: Time | None = None
        self.started = False
        self._waiting: tuple[int, Time] | None = None
        self._news: list[dict[str, Any]] = []
        self._roll_call = node.create_timer(ROLL_CALL_SECONDS, self._call_roll, clock=self._clock)
        self._watch = node.create_timer(WATCH_SECONDS, self.look, clock=self._clock, autostart=False)

    def look(self) -> None:
        """See which nodes publish, and keep it as news where that has changed; done once a second, too."""
        try:
            for topic, nodes in self._publishers.changes():
                self._node.get_logger().warning(f"{topic.name} is now published by {', '.join(nodes)}")
                self._news.append({"topic": topic.name, "nodes": nodes})
            if self._lossless:
                self._on_watch()
        except Exception as error:
            self._node.fail(error)

    def news(self) -> list[dict[str, Any]]:
        """Topics and the nodes that publish them now, where that has changed since the last call."""
        news, self._news = self._news, []
        return news

    def has_publisher(self, topic: Topic) -> bool:
        """Whether something is there that publishes a topic."""
        return bool(self._readers[topic].handle.get_publisher_count() > 0)

    def waited_long(self, stamp: int, topics: Collection[Topic]) -> bool:
        """Whether what the tick of this stamp [ns] lacks has been waited for long enough, asked again and again."""
        now = self._clock.now()
        if self._waiting is None or self._waiting[0] != stamp:
            self._waiting = stamp, now
        patience = PATIENCE_SECONDS if any(map(self.has_publisher, topics)) else PATIENCE_ALONE_SECONDS
        return bool((now - self._waiting[1]).nanoseconds > patience * 1e9)

    def _call_roll(self) -> None:
        try:
            if self.started:
                self._on_watch()
                return
            absent = frozenset(topic for topic in self._required if not self.has_publisher(topic))
            if self._may_start(absent):
                self._start(absent)
        except Exception as error:
            # Out of a timer it would be a traceback, and the others would not know.
            self._node.fail(error)

    def _may_start(self, absent: frozenset[Topic]) -> bool:
        dispensable = DISPENSABLE if self._lossless else DISPENSABLE_PACED
        if any(topic.kind not in dispensable for topic in absent):
            self._present_since = None
            return False
        now = self._clock.now()
        self._present_since = self._present_since or now
        return not absent or (now - self._present_since).nanoseconds >= GRACE_SECONDS * 1e9

    def _start(self, absent: frozenset[Topic]) -> None:
        self.started = True
        self.look()
        self._watch.reset()
        if self._lossless:
            self._roll_call.cancel()
        self._on_start(absent)
