"""The messages of a run as its log has them: canonical, each once, with what follows from them."""

from __future__ import annotations

from collections.abc import Iterator

from space_robot_msgs_py.attitude import SOURCES, AttitudeAngles
from space_robot_msgs_py.codec.codecs import LOGGED, CommandCodec, TopicBytes, is_empty, peek_stamp
from space_robot_msgs_py.codec.sender_mark import SenderMark
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_STATES, TF, Topic
from space_robot_msgs_py.transforms import FrameTransforms
from space_robot_report.live.brief import Brief

# Stamps of a topic that are remembered: references come ahead of their states, and some messages are said again.
MAX_KEPT = 64

Message = tuple[Topic, int, bytes]


class Feed:
    """Takes raw messages off the graph and gives out what the log has of them.

    Args:
        brief: of the run.

    Attributes:
        topics: what there is in this run, in the order of the log.
        static: the message on ``/tf_static``; None where no joint is fixed.
        refused: how many messages did not fit.
    """

    def __init__(self, brief: Brief) -> None:
        self.topics = tuple(topic for topic in LOGGED if not topic.optional or topic in brief.optional)
        self._bytes, self._commands = TopicBytes(brief.joint_names), CommandCodec(brief.joint_names)
        self._marks = SenderMark(self._commands.layouts)
        self._frames = FrameTransforms(brief.urdf, brief.joint_names)
        self._angles = {AttitudeAngles(topic).source: (topic, AttitudeAngles(topic)) for topic in SOURCES}
        self._kept: dict[Topic, dict[int, bytes]] = {topic: {} for topic in self.topics}
        self.static, self.refused = self._frames.static, 0

    def read(self, topic: Topic, raw: bytes) -> Iterator[Message]:
        """The message with its stamp [ns], and what follows from it; nothing where it is known already, or none.

        Args:
            topic: one of ``topics``.
            raw: as the middleware gives it.
        """
        try:
            stamp, data = self._canonical(topic, raw)
        except SpaceRobotError:
            self.refused += 1
            return
        if topic.optional and is_empty(topic, data):
            return
        if topic is BASE_ODOM and stamp < max(self._kept[topic], default=0):
            # Time begins again.
            self._kept = {one: {} for one in self.topics}
        if self._is_news(topic, stamp, data):
            yield topic, stamp, data
            yield from self._derived(topic, stamp, data)

    def at(self, topic: Topic, stamp: int) -> bytes | None:
        """The message of a topic and a stamp [ns], if it was heard lately."""
        return self._kept[topic].get(stamp)

    def newest(self, topic: Topic) -> tuple[int, bytes] | None:
        """Stamp [ns] and bytes of what was heard last of a topic."""
        kept = self._kept.get(topic)
        return next(reversed(kept.items())) if kept else None

    def _canonical(self, topic: Topic, raw: bytes) -> tuple[int, bytes]:
        if topic.optional and is_empty(topic, raw):
            return peek_stamp(raw), raw
        if topic in self._commands.topics:
            raw = self._marks.remove(self._commands.topics.index(topic), raw)
        return self._bytes.read(topic, raw)

    def _is_news(self, topic: Topic, stamp: int, data: bytes) -> bool:
        kept = self._kept[topic]
        if kept.get(stamp) == data:
            return False
        kept.pop(stamp, None)
        kept[stamp] = data
        if len(kept) > MAX_KEPT:
            del kept[next(iter(kept))]
        return True

    def _derived(self, topic: Topic, stamp: int, data: bytes) -> Iterator[Message]:
        if topic in (BASE_ODOM, JOINT_STATES):
            transforms = self._frames.from_messages(self.at(BASE_ODOM, stamp), self.at(JOINT_STATES, stamp))
            if transforms is not None:
                yield TF, stamp, transforms
        if topic in self._angles:
            derived, angles = self._angles[topic]
            if (message := angles.of(data)) is not None:
                yield derived, stamp, message
