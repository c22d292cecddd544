"""Any rosbag2 bag: of this project or another tool, in one file or several, chunked, compressed, truncated."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from space_robot_msgs_py.bounded_files import path_kind, read_text, short
from space_robot_msgs_py.errors import InputFileError, LogError, SpaceRobotError
from space_robot_msgs_py.foreign_files import check_before_reading, foreign_messages
from space_robot_msgs_py.limits import METADATA_BYTES
from space_robot_msgs_py.log.directory import METADATA_FILE, description
from space_robot_msgs_py.log.mcap.records import MESSAGE, parse
from space_robot_msgs_py.log.mcap.salvage import Damage, Record, salvage
from space_robot_msgs_py.log.mcap.summary import read_summary

RECOVERED = "what `space-robot recover` makes of it"


class BagMessage(NamedTuple):
    """One message of a bag.

    Attributes:
        topic: as it is in the bag, mostly with a leading slash.
        type: ``package/msg/Name``; empty if the bag does not say.
        time: when it was recorded [ns].
        data: as its writer left it, mostly CDR.
        encoding: ``cdr``, or what the bag says it is.
    """

    topic: str
    type: str
    time: int
    data: bytes
    encoding: str = "cdr"


@dataclass(frozen=True, slots=True)
class Missing:
    """Messages that a bag counts, at the end of a file or in its description, and that cannot be found in it.

    Attributes:
        topic: as it is in the bag.
        count: how many there are.
    """

    topic: str
    count: int


class Bag:
    """A bag to be read message by message; damage stands in the stream where it is.

    Args:
        path: a bag directory or one of its files.

    Attributes:
        path: as given.
        files: the MCAP files in the order in which they were recorded; none if only rosbags can read the bag.

    Raises:
        InputFileError: there is no bag.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.files = _mcap_files(self.path)
        self._single = path_kind(self.path) == "file"

    def messages(self) -> Iterator[BagMessage | Damage | Missing]:
        """Every message in the order of the files, and behind those of a file, and of all, what is missing of them.

        Raises:
            InputFileError: the bag cannot be read at all.
        """
        left = Counter(self.counted())
        for item in self._own_messages() if self.files else self._foreign_messages():
            if isinstance(item, BagMessage):
                left[item.topic] -= 1
            elif isinstance(item, Missing):
                left[item.topic] -= item.count
            yield item
        yield from (Missing(*one) for one in left.items() if one[1] > 0)

    def counted(self) -> dict[str, int]:
        """Messages by topic that the description of a bag directory counts; nothing where it has none."""
        said = description(self.path).get("topics_with_message_count") if not self._single else None
        found: Counter[str] = Counter()
        for one in said if isinstance(said, list) else ():
            with suppress(LookupError, TypeError):
                topic, count = one["topic_metadata"]["name"], one["message_count"]
                # YAML has true and false, which Python counts with.
                if isinstance(topic, str) and type(count) is int:
                    found[topic] += count
        return dict(found)

    def _own_messages(self) -> Iterator[BagMessage | Damage | Missing]:
        for file in self.files:
            channels, found = Channels(str(file)), Counter[int]()
            # Before the messages: a log that is closed meanwhile has all of them, and more than it had.
            summary = read_summary(file)
            for item in salvage(file):
                if isinstance(item, Damage):
                    yield item
                elif item.opcode == Opcode.MESSAGE:
                    number, _, time, _ = MESSAGE.unpack_from(item.content)
                    topic, ros_type, encoding = channels.name(number)
                    # Of a topic that the file no longer names here it is missing.
                    found[number] += bool(topic)
                    yield BagMessage(topic, ros_type, time, item.content[MESSAGE.size :], encoding)
                else:
                    channels.take(item)
            if summary is not None:
                yield from (Missing(*one) for one in summary.missing(found).items())

    def _foreign_messages(self) -> Iterator[BagMessage | Damage]:
        """What is not plain MCAP (SQLite, compression by rosbag2) is left to rosbags."""
        try:
            for place in self._places():
                check_before_reading(place)
                for one in foreign_messages(place):
                    yield BagMessage(one.topic, one.type, one.time, one.data, one.encoding)
        except SpaceRobotError:
            raise
        except Exception as error:
            # What a corrupted bag makes rosbags, SQLite and the decompressors raise has no common base.
            raise InputFileError(f"cannot be read as a bag: {error}", key=str(self.path)) from None

    def _places(self) -> list[Path]:
        """What rosbags is to read: each file, whatever a description says of it, or the bag that rosbag2 compressed."""
        files = sorted(self.path.glob("*.db3"), key=_natural) if not self._single else []
        return files if files and not _is_compressed(self.path) else [self.path]


class Channels:
    """Channels and schemas of one file, as they come by.

    Args:
        key: the file, for error messages.
    """

    def __init__(self, key: str) -> None:
        self._key = key
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}

    def take(self, record: Record) -> None:
        """Look at a record; only schemas and channels matter."""
        # A second one of a number has to be the same; else every message could be on a topic of its own.
        if record.opcode == Opcode.SCHEMA:
            schema = parse(Schema.read, record.content, self._key)
            self.schemas.setdefault(schema.id, schema)
        elif record.opcode == Opcode.CHANNEL:
            channel = parse(Channel.read, record.content, self._key)
            self.channels.setdefault(channel.id, channel)

    def name(self, channel: int) -> tuple[str, str, str]:
        """Topic, type and encoding of a channel; empty where the file no longer says."""
        found = self.channels.get(channel)
        if found is None:
            return "", "", ""
        schema = self.schemas.get(found.schema_id)
        return found.topic, schema.name if schema is not None else "", found.message_encoding


def _mcap_files(path: Path) -> tuple[Path, ...]:
    kind = path_kind(path)
    if kind == "file":
        return () if path.suffix in (".db3", ".zstd") else (path,)
    if kind != "directory":
        raise InputFileError("no such bag", key=short(path), accepted="a bag directory or an .mcap file")
    files = sorted(path.glob("*.mcap"), key=_natural)
    if not files and not [*path.glob("*.db3"), *path.glob("*.zstd")]:
        raise InputFileError("no bag in this directory", key=short(path), accepted="*.mcap, *.db3 or *.zstd")
    return () if _is_compressed(path) else tuple(files)


def _is_compressed(place: Path) -> bool:
    """True if rosbag2 has compressed messages or files itself, which no record of the files tells."""
    try:
        text = read_text(place / METADATA_FILE, METADATA_BYTES)
    except InputFileError:
        return False
    return re.search(r"^\s*compression_mode:\s*['\"]?\w", text, re.MULTILINE) is not None


def _natural(path: Path) -> list[str]:
    # As texts of one length: Python makes no integer of 5,000 digits, and of some digits none at all.
    return [part.rjust(255, "0") if part.isdecimal() else part for part in re.split(r"(\d+)", path.name)]


def intact(stream: Iterator[BagMessage | Damage | Missing], key: str) -> Iterator[BagMessage]:
    """The messages of a bag that must not be damaged; one that was truncated just ends earlier.

    Raises:
        LogError: something in the middle is lost, or messages are missing.
    """
    lost: Damage | None = None
    for item in stream:
        if isinstance(item, Damage):
            lost = lost or item
        elif lost is not None and lost.cut and isinstance(item, Missing):
            continue
        elif lost is not None:
            raise LogError(f"damaged at byte {lost.offset}: {lost.what}", key=key, accepted=RECOVERED)
        elif isinstance(item, Missing):
            what = f"{item.count} messages on {item.topic} are missing, which the bag counts at its end"
            raise LogError(what, key=key, accepted=RECOVERED)
        else:
            yield item
