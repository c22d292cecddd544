"""What an indexed MCAP file says of itself at its end, without a look at its messages."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel, Footer, MessageIndex, Metadata, MetadataIndex, Schema, Statistics

from space_robot_msgs_py.bounded_files import open_regular
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.limits import RECORD_BYTES
from space_robot_msgs_py.log.mcap.records import MAGIC, PREFIX, parse, walk

_FOOTER_SIZE = PREFIX.size + 20 + len(MAGIC)
# Of a chunk index: times of its first and last message, its place and length, and the length of a map behind them.
_CHUNK = struct.Struct("<QQQQI")
_ENTRY = np.dtype([("channel", "<u2"), ("offset", "<u8")])


@dataclass(frozen=True, slots=True)
class SummaryTopic:
    """One topic of a file.

    Attributes:
        name: as in the bag.
        type: ``package/msg/Name``; empty if the file does not say.
        count: of its messages.
        first: time of the first [ns].
        last: time of the last [ns].
    """

    name: str
    type: str
    count: int
    first: int
    last: int


@dataclass(frozen=True, eq=False, slots=True)
class Summary:
    """The index of a file, whose numbers agree with each other and with its checksum, if it has one.

    Attributes:
        path: the file.
        counts: messages by number of their channel; channels without any are not in it.
        channels: number to topic and number of the schema.
        types: number of a schema to ``package/msg/Name``.
        chunks: contents of the chunk indexes, in the order of the chunks.
        metadata_places: where metadata records are.
    """

    path: Path
    counts: Mapping[int, int]
    channels: Mapping[int, tuple[str, int]]
    types: Mapping[int, str]
    chunks: Sequence[bytes]
    metadata_places: Sequence[int]

    def missing(self, found: Mapping[int, int]) -> dict[str, int]:
        """Messages by topic that the file counts at its end and that are not in what was read of it.

        Args:
            found: messages that were read, by number of their channel.
        """
        lost = {number: count - found.get(number, 0) for number, count in self.counts.items()}
        return {self._topic(number): count for number, count in lost.items() if count > 0}

    def topics(self) -> tuple[SummaryTopic, ...]:
        """Every topic with messages, by number of its channel.

        Raises:
            LogError: the index of a chunk is damaged.
        """
        with open_regular(self.path) as stream:
            first, last = self._times(stream, self.chunks, min), self._times(stream, self.chunks[::-1], max)
        if not first.keys() == last.keys() == self.counts.keys():
            raise LogError("its index is damaged: a topic with messages is in no chunk", key=str(self.path))
        return tuple(
            SummaryTopic(self._topic(number), self._type(number), count, first[number], last[number])
            for number, count in self.counts.items()
        )

    def metadata(self) -> dict[str, dict[str, str]]:
        """Name to entries of every metadata record; of several of one name the last.

        Raises:
            LogError: one is damaged.
        """
        found = {}
        with open_regular(self.path) as stream:
            for place in self.metadata_places:
                record: Metadata = parse(Metadata.read, self._record(stream, place, Opcode.METADATA), str(self.path))
                found[record.name] = record.metadata
        return found

    def _topic(self, number: int) -> str:
        return self.channels[number][0] if number in self.channels else f"channel {number}"

    def _type(self, number: int) -> str:
        return self.types.get(self.channels[number][1], "") if number in self.channels else ""

    def _times(self, stream: IO[bytes], chunks: Sequence[bytes], pick: Callable[[list[int]], int]) -> dict[int, int]:
        """A time of every channel, out of the first chunk that has a message of it."""
        found: dict[int, int] = {}
        for content in chunks:
            for number, place in self._places(content):
                if number in self.counts and number not in found:
                    raw = self._record(stream, place, Opcode.MESSAGE_INDEX)
                    index: MessageIndex = parse(MessageIndex.read, raw, str(self.path))
                    if index.channel_id != number or not index.records:
                        raise LogError("its index is damaged: that of another topic", key=str(self.path))
                    found[number] = pick([time for time, _ in index.records])
            if len(found) == len(self.counts):
                break
        return found

    def _places(self, content: bytes) -> list[tuple[int, int]]:
        """Number of each channel with messages in a chunk, and where their index is."""
        try:
            *_, length = _CHUNK.unpack_from(content)
            entries = np.frombuffer(content, _ENTRY, length // _ENTRY.itemsize, _CHUNK.size)
        except (struct.error, ValueError):
            raise LogError("its index is damaged: too short for a chunk", key=str(self.path)) from None
        return list(zip(entries["channel"].tolist(), entries["offset"].tolist(), strict=True))

    def _record(self, stream: IO[bytes], place: int, expected: int) -> bytes:
        # A place beyond the file may be one that no file can have.
        stream.seek(min(place, os.fstat(stream.fileno()).st_size))
        prefix = stream.read(PREFIX.size)
        opcode, length = PREFIX.unpack(prefix) if len(prefix) == PREFIX.size else (0, 0)
        if opcode != expected or length > RECORD_BYTES.most:
            raise LogError(f"its index is damaged: another record at byte {place}", key=str(self.path))
        return stream.read(length)


def read_summary(path: Path) -> Summary | None:
    """The summary of a file; None where it has none that can be relied on: it was cut, is damaged or not indexed.

    Raises:
        InputFileError: there is no such file.
    """
    with open_regular(path) as stream:
        return summary_in(stream, path)


def summary_in(stream: IO[bytes], path: Path) -> Summary | None:
    """``read_summary`` of an open file, whose position it changes."""
    try:
        section = _section(stream, os.fstat(stream.fileno()).st_size, str(path))
        return _summary(path, section) if section is not None else None
    except (SpaceRobotError, struct.error, ValueError, LookupError):
        return None


def _section(stream: IO[bytes], size: int, key: str) -> bytes | None:
    """The records in front of the footer that tell what is in the file."""
    stream.seek(max(0, size - _FOOTER_SIZE))
    end = stream.read(_FOOTER_SIZE)
    opcode, length = PREFIX.unpack_from(end)
    if opcode != Opcode.FOOTER or length != 20 or not end.endswith(MAGIC):
        return None
    footer: Footer = parse(Footer.read, end[PREFIX.size :], key)
    start, stop = footer.summary_start, size - _FOOTER_SIZE
    if not 0 < start < stop or stop - start > RECORD_BYTES.most:
        return None
    stream.seek(start)
    section = stream.read(stop - start)
    # The checksum covers the footer too, up to the checksum itself.
    crc = zlib.crc32(section + end[: PREFIX.size + 16])
    return section if footer.summary_crc in (0, crc) else None


def _summary(path: Path, section: bytes) -> Summary | None:
    records: dict[int, list[bytes]] = {}
    for opcode, content in walk(section):
        records.setdefault(opcode, []).append(content)
    key = str(path)
    (content,) = records[Opcode.STATISTICS]
    statistics: Statistics = parse(Statistics.read, content, key)
    counts = {number: count for number, count in sorted(statistics.channel_message_counts.items()) if count}
    if sum(counts.values()) != statistics.message_count:
        return None
    channels = [parse(Channel.read, content, key) for content in records.get(Opcode.CHANNEL, ())]
    schemas = [parse(Schema.read, content, key) for content in records.get(Opcode.SCHEMA, ())]
    places = [parse(MetadataIndex.read, content, key).offset for content in records.get(Opcode.METADATA_INDEX, ())]
    return Summary(
        path=path,
        counts=counts,
        channels={channel.id: (channel.topic, channel.schema_id) for channel in channels},
        types={schema.id: schema.name for schema in schemas},
        chunks=records.get(Opcode.CHUNK_INDEX, []),
        metadata_places=places,
    )
