"""Copies the readable records of a bag, which may be several files, into one indexed file."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from mcap.opcode import Opcode
from mcap.records import Channel, Header, Metadata, Schema, Statistics

from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import METADATA_BYTES
from space_robot_msgs_py.log.bag import Bag, Channels
from space_robot_msgs_py.log.directory import BagTopic
from space_robot_msgs_py.log.header import METADATA_NAME
from space_robot_msgs_py.log.mcap.index import IndexedWriter
from space_robot_msgs_py.log.mcap.records import MESSAGE, PREFIX, parse, record_bytes
from space_robot_msgs_py.log.mcap.salvage import Damage, Record, salvage
from space_robot_msgs_py.log.numbering import Numbering
from space_robot_msgs_py.log.preamble import LIBRARY

# What rosbag2 keeps of its own metadata in a file speaks of the file as it was.
STALE = "rosbag2"
# The schema of a channel that has none, such as one of JSON.
NO_SCHEMA = 0
HASH, OFFERS = "topic_type_hash", "offered_qos_profiles"


class BagMerger:
    """Reads a bag twice: first what its channels are, which a corrupted file may say late, then everything else.

    Args:
        bag: of MCAP files.

    Attributes:
        kept: messages by topic that were written.
        nameless: messages whose channel is lost.
        damage: of the bag.
        first: log time of the first message [ns].
        last: log time of the last message [ns].
    """

    def __init__(self, bag: Bag) -> None:
        self._bag = bag
        self.kept: Counter[str] = Counter()
        self.nameless = 0
        self.damage: list[Damage] = []
        self.first = self.last = 0
        self._numberings: dict[Path, Numbering] = {}
        # By file what it counts at its end, for those that do.
        self._counted: dict[Path, Counter[str]] = {}
        self._header = Header("ros2", "")
        self._channels: dict[str, tuple[Channel, Schema | None]] = {}
        self._numbers: dict[str, int] = {}
        self._by_file: dict[Path, Channels] = {}
        for file in bag.files:
            self._learn(file)

    def write(self, path: Path) -> None:
        """Write the new file; it is on the disk when this returns."""
        with path.open("wb") as stream:
            writer = IndexedWriter(stream, str(path))
            _add(writer, record_bytes(self._header))
            announced = False
            for file in self._bag.files:
                for item in salvage(file):
                    if isinstance(item, Damage):
                        self.damage.append(item)
                    elif item.opcode == Opcode.MESSAGE:
                        if not announced:
                            self._announce(writer)
                            announced = True
                        self._copy(writer, file, item)
                    elif self._is_kept(item, file):
                        writer.add(item.opcode, item.content)
            writer.finish()
            stream.flush()
            os.fsync(stream.fileno())

    def topics(self) -> list[BagTopic]:
        """What ``metadata.yaml`` says of the new bag."""
        return [
            BagTopic(
                topic,
                schema.name if schema is not None else "",
                self.kept[topic],
                _offers(channel.metadata.get(OFFERS, "")),
                channel.metadata.get(HASH, ""),
                channel.message_encoding,
            )
            for topic, (channel, schema) in self._channels.items()
        ]

    def lost(self) -> dict[str, int]:
        """Messages by topic that are known to be missing: what a file counts at its end, or gaps in its numbers."""
        missing: Counter[str] = Counter()
        for file in self._bag.files:
            numbers = self._numbering(file)
            missing += self._counted[file] - numbers.kept() if file in self._counted else numbers.lost()
        return dict(missing)

    def _learn(self, file: Path) -> None:
        channels = self._by_file[file] = Channels(str(file))
        statistics: Statistics | None = None
        headed = False
        for item in salvage(file):
            if isinstance(item, Damage) or item.opcode == Opcode.MESSAGE:
                continue
            channels.take(item)
            if item.opcode == Opcode.HEADER and not headed:
                headed, self._header = True, parse(Header.read, item.content, str(file))
            elif item.opcode == Opcode.METADATA and not headed:
                # The first record may be the one that is damaged.
                headed = parse(Metadata.read, item.content, str(file)).name == METADATA_NAME
                self._header = Header("ros2", LIBRARY) if headed else self._header
            elif item.opcode == Opcode.STATISTICS:
                found = parse(Statistics.read, item.content, str(file))
                # A damaged count would be reported as a loss.
                consistent = found.message_count == sum(found.channel_message_counts.values())
                statistics = found if consistent else None
        if statistics is not None:
            self._counted[file] = Counter()
        for number, channel in channels.channels.items():
            schema = channels.schemas.get(channel.schema_id)
            # A channel without a schema has number 0; another that is not there was lost with what is damaged.
            if schema is not None or channel.schema_id == NO_SCHEMA:
                self._channels.setdefault(channel.topic, (channel, schema))
            if statistics is not None:
                self._counted[file][channel.topic] += statistics.channel_message_counts.get(number, 0)

    def _announce(self, writer: IndexedWriter) -> None:
        """All schemas and channels, renumbered: files of one bag may have numbers of their own."""
        schemas: dict[tuple[str, bytes], int] = {}
        for _, schema in self._channels.values():
            if schema is not None and (schema.name, schema.data) not in schemas:
                number = schemas[schema.name, schema.data] = len(schemas) + 1
                _add(writer, record_bytes(Schema(number, schema.data, schema.encoding, schema.name)))
        for topic, (channel, schema) in self._channels.items():
            number = self._numbers[topic] = len(self._numbers) + 1
            of = NO_SCHEMA if schema is None else schemas[schema.name, schema.data]
            _add(writer, record_bytes(Channel(number, topic, channel.message_encoding, channel.metadata, of)))

    def _copy(self, writer: IndexedWriter, file: Path, record: Record) -> None:
        channel, sequence, time, published = MESSAGE.unpack_from(record.content)
        topic = self._by_file[file].name(channel)[0]
        number = self._numbers.get(topic)
        if number is None:
            self.nameless += 1
            return
        self._numbering(file).take(channel, topic, sequence)
        head = MESSAGE.pack(number, self.kept[topic], time, published)
        writer.add(Opcode.MESSAGE, head + record.content[MESSAGE.size :])
        if not self.kept:
            self.first = time
        self.kept[topic] += 1
        self.last = max(self.last, time)

    def _numbering(self, file: Path) -> Numbering:
        return self._numberings.setdefault(file, Numbering(from_zero=self._header.library == LIBRARY))

    def _is_kept(self, record: Record, file: Path) -> bool:
        if record.opcode == Opcode.METADATA:
            return bool(parse(Metadata.read, record.content, str(file)).name != STALE)
        return record.opcode == Opcode.ATTACHMENT


def _add(writer: IndexedWriter, record: bytes) -> None:
    opcode, _ = PREFIX.unpack_from(record)
    writer.add(opcode, record[PREFIX.size :])


@cache
def _offers(text: str) -> tuple[Mapping[str, Any], ...]:
    """The offered quality of service that a channel carries as YAML; none where it is unreadable."""
    try:
        offers = load_yaml(text, OFFERS, METADATA_BYTES)
    except SpecError:
        return ()
    return tuple(offer for offer in offers if isinstance(offer, dict)) if isinstance(offers, list) else ()
