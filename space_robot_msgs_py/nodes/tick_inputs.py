"""State and reference of equal stamp, and what else belongs to it, as a node hears them: checked and joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from space_robot_msgs_py.codec.codecs import ReferenceCodec, StateCodec, WheelMomentumCodec
from space_robot_msgs_py.codec.values import Blocks, PartsCodec, all_finite
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Reference, RobotState
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic

JOIN_CAPACITY = 1024
# More than guidance says again.
MAX_USED = 64
# Gives the stamp of a message [ns], or raises SpaceRobotError where it does not fit.
Reader = Callable[[bytes], int]
Take = Callable[[RobotState, Reference, tuple[bytes, ...]], None]


class TickInputs:
    """Listens to the parts of state and reference and gives each tick out when it is complete.

    Args:
        node: that listens, and refuses what does not fit.
        joint_names: the robot's joints in model order.
        take: called with state, reference, and the messages of the other topics.
        beside: further topics that have one message at every stamp, and how to read it.
        repeated: called with the stamp [ns] when the state that was given out last is heard again.
        wheels: states have the momentum of the wheels.

    Attributes:
        topics: what is listened to.
    """

    def __init__(
        self,
        node: GraphNode,
        joint_names: Sequence[str],
        take: Take,
        beside: Sequence[tuple[Topic, Reader]] = (),
        repeated: Callable[[int], None] = lambda stamp: None,
        *,
        wheels: bool = False,
    ) -> None:
        self._node, self._take, self._repeated = node, take, repeated
        self.forget()
        # The stamps that were given out last, and references that came for them afterwards.
        self._used: dict[int, dict[int, Blocks]] = {}
        self._state, self._reference = StateCodec(joint_names), ReferenceCodec(joint_names)
        self._wheels = WheelMomentumCodec() if wheels else None
        measured: tuple[PartsCodec[Any], ...] = (self._state,) if self._wheels is None else (self._state, self._wheels)
        self._codecs = [(codec, part) for codec in (*measured, self._reference) for part in range(len(codec.topics))]
        self._whole = len(self._codecs)
        self._split = self._whole - len(self._reference.topics)
        self.topics = (*(codec.topics[part] for codec, part in self._codecs), *(topic for topic, _ in beside))
        self._joiner: StampJoiner[Blocks] = StampJoiner(
            len(self.topics), JOIN_CAPACITY, once=False, choose=self._choose
        )
        for index in range(self._whole):
            self._listen_part(index)
        for index, (topic, read) in enumerate(beside, start=self._whole):
            self._listen_beside(index, topic, read)

    @property
    def malformed(self) -> int:
        """How many messages were refused because they do not fit."""
        return sum(self._node.refusals[topic.name] for topic in self.topics)

    def forget(self) -> None:
        """A new run: a state that is heard again is a new one."""
        self._given, self._given_parts = -1, tuple[Blocks, ...]()

    def _listen_part(self, index: int) -> None:
        topic = self.topics[index]
        codec, part = self._codecs[index]

        def on_part(raw: bytes) -> None:
            try:
                # Checked alone: a part that does not fit must not take those of its stamp down with it.
                stamp, blocks = codec.hear_part(part, raw)
            except SpaceRobotError as error:
                self._node.refuse(topic, error)
                return
            self._add(index, stamp, blocks)

        self._node.listen(topic, on_part)

    def _listen_beside(self, index: int, topic: Topic, read: Reader) -> None:
        def on_message(raw: bytes) -> None:
            try:
                stamp = read(raw)
            except SpaceRobotError as error:
                self._node.refuse(topic, error)
                return
            self._add(index, stamp, (raw,))

        self._node.listen(topic, on_message)

    def _add(self, index: int, stamp: int, blocks: Blocks) -> None:
        if stamp == self._given and index < self._split and blocks == self._given_parts[index]:
            if index == 0:
                self._repeated(stamp)
            return
        if self._split <= index < self._whole:
            if stamp == 0:
                # Guidance begins again: what it said before for later stamps is of the run before.
                self._joiner.let_give_way(index, stamp)
            if stamp in self._used and stamp not in self._joiner:
                # Said again for a node that came later; where a run begins again, its state will tell.
                self._used[stamp][index] = blocks
                return
        elif waiting := self._used.get(stamp):
            for other, its in waiting.items():
                self._joiner.add(other, stamp, its)
            waiting.clear()
        joined = self._joiner.add(index, stamp, blocks)
        if joined is not None:
            self._join(stamp, joined)

    def _choose(self, index: int, there: Blocks, new: Blocks) -> Blocks:
        """Of two parts of one stamp: of a reference the older, of all else the newer: a stranger's comes early."""
        is_reference = self._split <= index < self._whole
        better, worse = (there, new) if is_reference else (new, there)
        if better == worse:
            return better
        self._node.refuse(self.topics[index], "two that differ have one stamp")
        return better if index >= self._whole or all_finite(better) else worse

    def _join(self, stamp: int, parts: Sequence[Blocks]) -> None:
        try:
            state = self._state.join(stamp, parts[: len(self._state.topics)])
            if self._wheels is not None:
                state = replace(state, wheel_momentum=self._wheels.join(stamp, parts[self._split - 1 : self._split])[1])
            reference = self._reference.join(stamp, parts[self._split : self._whole])
        except SpaceRobotError as error:
            for index, blocks in enumerate(parts):
                if index >= self._whole or all_finite(blocks):
                    self._joiner.add(index, stamp, blocks)
                else:
                    self._node.refuse(self.topics[index], error)
            return
        self._given, self._given_parts = stamp, tuple(parts[: self._split])
        self._used[stamp] = {}
        if len(self._used) > MAX_USED:
            del self._used[next(iter(self._used))]
        self._take(state, reference, tuple([blocks[0] for blocks in parts[self._whole :]]))
