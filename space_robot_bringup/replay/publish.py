"""What a bag has to say on the live graph: ticks, topics, joint names; everything but the nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from space_robot_bringup.logs.foreign_bag import PLAIN, Source, foreign_rows, names_and_urdf
from space_robot_bringup.replay.comparison import Comparison, Tolerance
from space_robot_msgs_py.codec.codecs import LOGGED, CommandCodec
from space_robot_msgs_py.errors import InputFileError, LogError, SpecError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import BASE_ODOM, Topic

SLOWEST, FASTEST = 1e-3, 1e4
ROLES = ("state", "all")


@dataclass(frozen=True, slots=True)
class PublishOptions:
    """How a bag is published.

    Attributes:
        role: ``state``: what the controller hears, the command is up to it; ``all``: everything, commands too.
        topics: only these; empty: what the role says.
        rate: recorded seconds per second; None: lock-step with the commands, where those are not published.
        paused: begin paused.
        loop: begin again after the last tick.
    """

    role: str = "state"
    topics: tuple[str, ...] = ()
    rate: float | None = None
    paused: bool = False
    loop: bool = False

    def __post_init__(self) -> None:
        if self.role not in ROLES:
            raise SpecError("no such part", key="--as", value=self.role, accepted=", ".join(ROLES))
        if self.rate is not None and not SLOWEST <= self.rate <= FASTEST:
            raise SpecError("not a usable rate", key="--rate", value=self.rate, accepted=f"{SLOWEST:g} to {FASTEST:g}")
        names = [topic.name for topic in LOGGED]
        for name in self.topics:
            if name.strip("/") not in names:
                raise SpecError("no such topic", key="--topics", value=name, accepted=", ".join(names))

    @property
    def published(self) -> tuple[Topic, ...]:
        """The rows of the table that are published, where the bag has them."""
        if self.topics:
            wanted = {name.strip("/") for name in self.topics}
            return tuple(topic for topic in LOGGED if topic.name in wanted)
        return tuple(topic for topic in LOGGED if self.role == "all" or topic.publisher != "controller")

    @property
    def pace(self) -> float | None:
        """None in lock-step; a bag that publishes the commands itself needs no answer."""
        return 1.0 if self.rate is None and any(topic.kind == "command" for topic in self.published) else self.rate


@dataclass(frozen=True, eq=False, slots=True)
class Broadcast:
    """A bag that can be published.

    Attributes:
        ticks: stamp [ns] and messages by topic.
        joint_names: of its robot.
        urdf: of its robot; empty if the bag has none.
        period: between two states [ns].
    """

    ticks: tuple[tuple[int, Mapping[Topic, bytes]], ...]
    joint_names: tuple[str, ...]
    urdf: str
    period: int


def open_broadcast(path: Path, source: Source = PLAIN) -> Broadcast:
    """Read a bag of any tool for publishing; no experiment is needed.

    Args:
        path: run directory, bag directory or one of its files.
        source: where the topics are in a bag of another tool.

    Raises:
        SpaceRobotError: there is no such bag, or there are no two states in it.
    """
    bag = Bag(path)
    try:
        reader = LogReader(path)
        names, urdf, rows = reader.header.joint_names, reader.header.urdf, list(reader.stamps())
    except (LogError, InputFileError):
        names, urdf = names_and_urdf(bag, source)
        rows, _ = foreign_rows(bag, names, source)
    table = {topic.name: topic for topic in LOGGED}
    ticks = tuple(
        (stamp, {table[name]: raw for name, raw in parts.items() if name in table})
        for stamp, parts in rows
        if BASE_ODOM.name in parts
    )
    if len(ticks) < 2:
        raise LogError("fewer than two states in it", key=str(path), accepted=f"messages on {BASE_ODOM.name}")
    return Broadcast(ticks, names, urdf, min(later[0] - earlier[0] for earlier, later in pairwise(ticks)))


class Answers:
    """Holds what a controller answers to recorded states against the recorded commands.

    Args:
        broadcast: the bag.
        tolerance: what counts as equal.

    Attributes:
        comparison: of all answers so far.
        unusable: answers that were no valid command.
    """

    def __init__(self, broadcast: Broadcast, tolerance: Tolerance) -> None:
        self._recorded = {stamp: {t.name: raw for t, raw in parts.items()} for stamp, parts in broadcast.ticks}
        self._codec = CommandCodec(broadcast.joint_names)
        self.comparison = Comparison(broadcast.joint_names, tolerance)
        self.unusable = 0

    @property
    def different(self) -> bool:
        """Something was answered otherwise than recorded, or could not be used."""
        return self.comparison.first is not None or self.unusable > 0

    def take(self, stamp: int, command: Command | None) -> None:
        """Compare one answer; None could not be used."""
        if command is None:
            self.unusable += 1
            return
        parts: Sequence[bytes] = self._codec.encode(command)
        self.comparison.compare(stamp, self._recorded[stamp], zip(self._codec.topics, parts, strict=True))
