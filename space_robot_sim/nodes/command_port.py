"""Where commands enter the simulator: joined by stamp, checked, counted, refused where they do not fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from space_robot_msgs_py.codecs import CommandCodec
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic

JOIN_CAPACITY = 64


class CommandPort:
    """Takes the parts of commands from the graph and offers at most one valid answer to the awaited stamp.

    A message with a stale or future stamp is counted and ignored. One with the awaited stamp but wrong names, wrong
    size or a number that is not finite counts as an answer that could not be used: the plant then holds.

    Args:
        node: the node to subscribe on.
        joint_names: names a joint command must carry, in this order.
        on_answer: called when the awaited stamp has its answer.
        keep_late: a valid command that comes too late may still be flown when nothing newer is there (paced runs).
    """

    def __init__(
        self, node: GraphNode, joint_names: tuple[str, ...], on_answer: Callable[[], None], *, keep_late: bool
    ) -> None:
        self._node, self._on_answer, self._keep_late = node, on_answer, keep_late
        self._codec = CommandCodec(joint_names)
        self._joiner: StampJoiner[bytes] = StampJoiner(len(self._codec.topics), JOIN_CAPACITY, once=False)
        self._awaited = 0
        self._newest: Command | None = None
        self._answer: Command | None = None
        self.answered = False
        self.counts: Counter[str] = Counter()
        for index, topic in enumerate(self._codec.topics):
            self._listen_part(index, topic)

    def expect(self, stamp: int) -> None:
        """Await the answer to the state with this stamp [ns]; going back in time forgets older commands."""
        if stamp < self._awaited:
            self._joiner.clear()
            self._newest = None
        self._awaited = stamp
        self._answer, self.answered = None, False

    def take(self) -> Command | None:
        """The answer to the awaited stamp; None where it could not be used."""
        return self._answer

    def take_newest(self) -> Command | None:
        """The newest valid command not flown yet, counting what is missing; None where there is none."""
        if self.answered:
            return self._answer
        self.counts["missed"] += 1
        late, self._newest = self._newest, None
        return late

    def _listen_part(self, index: int, topic: Topic) -> None:
        def on_part(raw: bytes) -> None:
            try:
                stamp = self._codec.peek(index, raw)
            except SpaceRobotError as error:
                self._refuse("malformed", topic, error)
                return
            if self._in_time(stamp, topic):
                joined = self._joiner.add(index, stamp, raw)
                if joined is not None:
                    self._take_in(stamp, joined, topic)

        self._node.listen(topic, on_part)

    def _in_time(self, stamp: int, topic: Topic) -> bool:
        if stamp > self._awaited:
            self._refuse("future", topic, f"stamp {stamp} ns is ahead of the state at {self._awaited} ns")
            return False
        if stamp < self._awaited:
            self.counts["late"] += 1
            if not self._keep_late:
                self._refuse("stale", topic, f"stamp {stamp} ns is older than the state at {self._awaited} ns")
                return False
        return True

    def _take_in(self, stamp: int, parts: tuple[bytes, ...], topic: Topic) -> None:
        try:
            command: Command | None = self._codec.decode(parts)
        except SpaceRobotError as error:
            self._refuse("invalid", topic, error)
            command = None
        if stamp == self._awaited and not self.answered:
            self._answer, self.answered = command, True
            self._on_answer()
        elif stamp < self._awaited and command is not None:
            self._newest = command

    def _refuse(self, what: str, topic: Topic, why: object) -> None:
        self.counts[what] += 1
        if self.counts[what] == 1:
            self._node.get_logger().warning(f"refused a {what} message on {topic.name}: {why}")
