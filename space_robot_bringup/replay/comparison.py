"""Recorded and recomputed messages compared number by number."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from space_robot_msgs_py.codec.message_fields import MessageFields
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.topics import TABLE, Topic

Value = float | str | None


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far numbers may be apart: |fresh - recorded| <= atol + rtol * largest |recorded| of their block.

    A block is what has one unit and one meaning, such as the joint efforts of a message. With both zero, which is the
    default, the bits have to be equal.

    Attributes:
        rtol: relative [-].
        atol: absolute, in the unit of the field.
        ignore: ``topic`` or ``topic/block`` that are not compared.
    """

    rtol: float = 0.0
    atol: float = 0.0
    ignore: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, value in (("--rtol", self.rtol), ("--atol", self.atol)):
            if not (np.isfinite(value) and value >= 0.0):
                raise SpecError("not a tolerance", key=name, value=value, accepted="a number from 0")
        for text in self.ignore:
            if not any(text == topic.name or text.startswith(f"{topic.name}/") for topic in TABLE):
                names = ", ".join(topic.name for topic in TABLE if topic.recorded)
                raise SpecError(
                    "no such topic", key="--ignore", value=text, accepted=f"topic or topic/block of {names}"
                )

    @property
    def exact(self) -> bool:
        """Only equal bits will do."""
        return self.rtol == self.atol == 0.0


EXACT = Tolerance()


@dataclass(frozen=True, slots=True)
class Divergence:
    """One number that is different.

    Attributes:
        topic: as in the table.
        stamp: [ns].
        field: of the message, e.g. ``effort[joint2]``.
        recorded: None: there is no such number.
        fresh: None: there is no such number.
    """

    topic: str
    stamp: int
    field: str
    recorded: Value
    fresh: Value

    @property
    def distance(self) -> float:
        """How far apart; infinite where one of them is no number."""
        if isinstance(self.recorded, float) and isinstance(self.fresh, float):
            return abs(self.fresh - self.recorded)
        return float("inf")


class Comparison:
    """Collects what is different, in the order of the log.

    Args:
        joint_names: the robot's joints in model order.
        tolerance: what still counts as equal.

    Attributes:
        first: the first number that is different; None: everything is equal.
        worst: by (topic, block) the number that is furthest off.
        differing: by (topic, block) how many messages are different.
        compared: messages by topic.
    """

    def __init__(self, joint_names: Sequence[str], tolerance: Tolerance) -> None:
        self._fields, self._tolerance = MessageFields(joint_names), tolerance
        self._ignored_topics = frozenset(name for name in tolerance.ignore)
        self.first: Divergence | None = None
        self.worst: dict[tuple[str, str], Divergence] = {}
        self.differing: Counter[tuple[str, str]] = Counter()
        self.compared: Counter[str] = Counter()

    def compare(self, stamp: int, recorded: Mapping[str, bytes], fresh: Iterable[tuple[Topic, bytes]]) -> None:
        """Hold fresh messages of one stamp against those of the log; what the log has not is not looked at."""
        for topic, now in fresh:
            was = recorded.get(topic.name)
            if was is None or topic.name in self._ignored_topics:
                continue
            self.compared[topic.name] += 1
            if was != now:
                self._look_closer(stamp, topic, was, now)

    def event(self, topic: str, stamp: int, field: str, recorded: str, fresh: str) -> None:
        """Hold two texts against each other, such as the reason of an end."""
        if recorded != fresh and topic not in self._ignored_topics:
            self._note((topic, field), Divergence(topic, stamp, field, recorded, fresh))

    def _look_closer(self, stamp: int, topic: Topic, was: bytes, now: bytes) -> None:
        try:
            recorded = self._fields.blocks(topic, was)
        except SpaceRobotError as error:
            self._note((topic.name, "layout"), Divergence(topic.name, stamp, "layout", str(error), "fits"))
            return
        fresh = self._fields.blocks(topic, now)
        if self._tolerance.exact and recorded.keys() == fresh.keys():
            self.event(topic.name, stamp, "order of blocks", ", ".join(recorded), ", ".join(fresh))
        for block in dict.fromkeys((*recorded, *fresh)):
            if f"{topic.name}/{block}" in self._ignored_topics:
                continue
            found = self._block(stamp, topic, block, recorded.get(block), fresh.get(block))
            if found is not None:
                self._note((topic.name, block), found)

    def _block(self, stamp: int, topic: Topic, block: str, was: Vector | None, now: Vector | None) -> Divergence | None:
        """The number that is furthest off, if any is off too far."""
        if was is None or now is None or was.size != now.size:
            sizes = [None if block is None else f"{block.size} numbers" for block in (was, now)]
            return Divergence(topic.name, stamp, block, *sizes)
        with np.errstate(all="ignore"):
            distance = np.nan_to_num(np.abs(now - was), nan=np.inf)
            if self._tolerance.exact:
                off = was.view(np.int64) != now.view(np.int64)
            else:
                # A number that is not finite is never close to one that is.
                finite = np.isfinite(was)
                scale = np.max(np.abs(was), where=finite, initial=0.0)
                off = ~finite | (distance > self._tolerance.atol + self._tolerance.rtol * scale)
        if not off.any():
            return None
        index = int(np.argmax(np.where(off, distance, -1.0)))
        name = self._fields.name(topic, block, index, was.size)
        return Divergence(topic.name, stamp, name, float(was[index]), float(now[index]))

    def _note(self, place: tuple[str, str], found: Divergence) -> None:
        self.first = self.first or found
        self.differing[place] += 1
        before = self.worst.get(place)
        if before is None or found.distance > before.distance:
            self.worst[place] = found
