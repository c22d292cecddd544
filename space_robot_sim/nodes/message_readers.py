"""How a recorder reads the messages of a tick: stamp and canonical bytes, without the mark of a sender."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from space_robot_msgs_py.codec.codecs import CommandCodec, TopicBytes, peek_stamp, says_none
from space_robot_msgs_py.codec.sender_mark import SenderMark
from space_robot_msgs_py.topics import Topic

# Stamp [ns] and canonical bytes of a message; it raises LayoutError where that is none of its topic.
Reader = Callable[[bytes], tuple[int, bytes]]


class MessageReaders:
    """Readers of the topics of a tick.

    Args:
        joint_names: the robot's joints in model order.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        commands = CommandCodec(joint_names)
        self._canonical, self._marks = TopicBytes(joint_names), SenderMark(commands.layouts)
        self._parts = {topic: part for part, topic in enumerate(commands.topics)}

    def of(self, topic: Topic) -> Reader:
        """The reader of one topic."""
        read = self._canonical.reader(topic)
        if topic.optional:
            return lambda raw: (peek_stamp(raw), raw) if says_none(raw) else read(raw)
        if topic in self._parts:
            part, remove = self._parts[topic], self._marks.remove
            return lambda raw: read(remove(part, raw))
        return read
