"""Bags of other tools: the project's topics out of them, by stamp, in the canonical bytes everything else expects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from space_robot_msgs_py.codec.cdr import check_encapsulation, with_stamp
from space_robot_msgs_py.codec.codecs import LOGGED, TopicBytes, decode_string
from space_robot_msgs_py.codec.generic import parse
from space_robot_msgs_py.errors import LayoutError, LogError, SpaceRobotError, SpecError
from space_robot_msgs_py.limits import STATE_BYTES
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.log.bag import Bag, BagMessage, intact
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_STATES, ROBOT_DESCRIPTION, Topic

# Beyond, a stamp is no time of a run but one since 1970; telemetry cannot hold it either.
MAX_STAMP = 1 << 53
FIRST = "first"
STARTS = ("run", FIRST)
# What has its stamp in a header, and no other times in it.
_OF_A_TICK = frozenset(("state", "reference", "command"))


@dataclass(frozen=True, slots=True)
class Source:
    """Where the topics of the project are in a bag of another tool.

    Attributes:
        namespace: in front of the topics.
        start: what its stamps count from, ``run``, or ``first``: the first state is 0, for stamps since 1970.
    """

    namespace: str = ""
    start: str = "run"

    def __post_init__(self) -> None:
        if self.start not in STARTS:
            raise SpecError("no such choice", key="--start", value=self.start, accepted=", ".join(STARTS))

    def name(self, topic: Topic) -> str:
        """What a topic is called in the bag."""
        prefix = self.namespace.strip("/")
        return f"/{prefix}/{topic.name}" if prefix else f"/{topic.name}"


PLAIN = Source()


def foreign_rows(bag: Bag, joint_names: Sequence[str], source: Source = PLAIN) -> tuple[list[Row], list[str]]:
    """Messages by stamp, and remarks on what was left out.

    Messages belong together by the stamps in them, in whatever order they were recorded.

    Args:
        bag: with topics of the project; others in it are not looked at.
        joint_names: the robot's joints in model order.
        source: where they are in it.

    Raises:
        LogError: no topic of the project is in it that can be read, or it is corrupted in its middle.
    """
    reading = _Reading(joint_names, source)
    for message in intact(bag.messages(), str(bag.path)):
        reading.take(message)
    if not reading.table:
        raise _nothing(bag, source, reading)
    table = _from_first(reading, bag) if source.start == FIRST else reading.table
    rows = sorted(table.items())
    if rows[-1][0] >= MAX_STAMP:
        accepted = "ns since the start of the run, or --start first"
        raise LogError("its stamps are no times of a run", key=str(bag.path), value=rows[-1][0], accepted=accepted)
    return rows, reading.remarks()


def names_and_urdf(bag: Bag, source: Source = PLAIN) -> tuple[tuple[str, ...], str]:
    """Joint names and URDF as they are first on the topics of a bag; empty where they are not.

    Raises:
        LogError: the bag is corrupted in its middle.
    """
    names: tuple[str, ...] = ()
    urdf = ""
    for message in intact(bag.messages(), str(bag.path)):
        try:
            if message.topic == source.name(JOINT_STATES) and not names:
                STATE_BYTES.check(len(message.data), JOINT_STATES.name, LayoutError)
                names = tuple(parse(JOINT_STATES.type, message.data).name)
            elif message.topic == source.name(ROBOT_DESCRIPTION):
                urdf = decode_string(message.data)
        except SpaceRobotError:
            continue
        if names and urdf:
            break
    return names, urdf


class _Reading:
    """The topics of the project out of a stream of messages.

    Attributes:
        table: canonical messages by topic name, by stamp [ns].
        seen: every topic of the bag.
    """

    def __init__(self, joint_names: Sequence[str], source: Source) -> None:
        self._names = {source.name(topic): topic for topic in LOGGED}
        self._stamped = source.start != FIRST
        self.table: dict[int, dict[str, bytes]] = {}
        self.seen: set[str] = set()
        self._canonical = TopicBytes(joint_names)
        self._refused: dict[str, tuple[int, str]] = {}
        self._twice, self._unstamped = Counter[str](), Counter[str]()

    def take(self, message: BagMessage) -> None:
        """Look at the next message."""
        self.seen.add(message.topic)
        topic = self._names.get(message.topic)
        if topic is None:
            return
        if not self._stamped and topic.kind not in _OF_A_TICK:
            self._unstamped[topic.name] += 1
            return
        try:
            _check_encoding(message)
            stamp, data = self._canonical.read(topic, message.data)
        except SpaceRobotError as error:
            count, why = self._refused.get(topic.name, (0, str(error)))
            self._refused[topic.name] = count + 1, why
            return
        parts = self.table.setdefault(stamp, {})
        self._twice[topic.name] += topic.name in parts
        parts.setdefault(topic.name, data)

    def remarks(self) -> list[str]:
        """What was left out, a line each."""
        said = [f"{count} messages on {name} cannot be read ({why})" for name, (count, why) in self._refused.items()]
        said += [
            f"{count} stamps came twice on {name}: the first counts" for name, count in self._twice.items() if count
        ]
        left = "left out: --start first reads states, references and commands"
        return said + [f"{count} messages on {name} {left}" for name, count in self._unstamped.items()]


def _check_encoding(message: BagMessage) -> None:
    """Refuse what is not the plain CDR of ROS, by its name.

    Raises:
        LayoutError: it is JSON, protobuf, XCDR2 ...
    """
    if message.encoding not in ("cdr", ""):
        raise LayoutError("not CDR", key=message.topic, value=message.encoding, accepted="messages of ROS 2")
    check_encapsulation(message.data, message.topic)


def _from_first(reading: _Reading, bag: Bag) -> dict[int, dict[str, bytes]]:
    """The messages from the first state on, with its stamp as 0.

    Raises:
        LogError: there is no state.
    """
    first = min((stamp for stamp, parts in reading.table.items() if BASE_ODOM.name in parts), default=None)
    if first is None:
        raise LogError("no state in it to count from", key=str(bag.path), accepted=f"messages on {BASE_ODOM.name}")
    return {
        stamp - first: {name: with_stamp(data, stamp - first) for name, data in parts.items()}
        for stamp, parts in reading.table.items()
        if stamp >= first
    }


def _nothing(bag: Bag, source: Source, reading: _Reading) -> LogError:
    """Say which topics there are and why they cannot be read, or the namespace that would have worked."""
    if remarks := reading.remarks():
        return LogError("no message of our topics can be read", key=str(bag.path), value="; ".join(remarks))
    tail = f"/{BASE_ODOM.name}"
    spaces = sorted(name.removesuffix(tail) for name in reading.seen if name.endswith(tail) and name != tail)
    accepted = f"--namespace {spaces[0].strip('/')}" if spaces else f"messages on {source.name(BASE_ODOM)} ..."
    found = ", ".join(sorted(reading.seen)) or "no message"
    return LogError("none of our topics is in it", key=str(bag.path), value=found, accepted=accepted)
