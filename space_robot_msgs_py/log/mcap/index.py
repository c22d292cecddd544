"""Turns a plain sequence of records into an indexed, compressed MCAP file that every reader can seek in."""

from __future__ import annotations

import os
import zlib
from collections import Counter
from collections.abc import Mapping
from struct import Struct
from typing import IO

import numpy as np
import zstandard
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    McapRecord,
    Metadata,
    MetadataIndex,
    Statistics,
    SummaryOffset,
)

from space_robot_msgs_py.log.mcap.positions import Integers, Positions, Stretch
from space_robot_msgs_py.log.mcap.records import (
    MAGIC,
    MESSAGE_OPCODE,
    PREFIX,
    flatten,
    message_head,
    parse,
    record_bytes,
    scan,
)

_MESSAGE_INDEX, _INDEX_OPCODE = Struct("<BQHI"), int(Opcode.MESSAGE_INDEX)
# One damaged byte costs a whole chunk; smaller ones compress worse (1 MiB saves 4 %).
CHUNK_SIZE = 1 << 17


def write_indexed(incoming: IO[bytes], outgoing: IO[bytes], key: str, known: Positions | None = None) -> None:
    """Copy a file with its messages in zstd chunks and an index behind them; what is in it stays the same.

    Args:
        incoming: an MCAP file, whole or cut; what stands behind its last complete record is left out.
        outgoing: an empty file; its content is on the disk when this returns.
        key: name of the first, for error messages.
        known: where all messages of the file stand, which spares a look at each.
    """
    size, start = os.fstat(incoming.fileno()).st_size, len(MAGIC)
    writer = IndexedWriter(outgoing, key)
    # A file that another program cut meanwhile has less than is known of it.
    if known is not None and known.start < known.stop <= size:
        _copy(incoming, writer, start, known.start)
        incoming.seek(known.start)
        for stretch in known.stretches(CHUNK_SIZE):
            writer.add_stretch(incoming.read(stretch.stop - stretch.start), stretch)
        start = known.stop
    _copy(incoming, writer, start, size)
    writer.finish()
    outgoing.flush()
    os.fsync(outgoing.fileno())


def _copy(incoming: IO[bytes], writer: IndexedWriter, start: int, stop: int) -> None:
    """The records between two places of a file."""
    incoming.seek(start)
    for opcode, content in flatten(scan(incoming, stop, start), writer.key):
        writer.add(opcode, content)


class IndexedWriter:
    """Takes records one by one and writes them with chunks and an index.

    Args:
        stream: an empty file.
        key: its name, for error messages.

    Attributes:
        key: the same.
    """

    def __init__(self, stream: IO[bytes], key: str) -> None:
        self._stream, self.key = stream, key
        self._position = 0
        self._compressor = zstandard.ZstdCompressor(level=3)
        self._chunk = bytearray()
        # By channel: stamp, offset, stamp, offset, ... of its messages in the chunk.
        self._entries: dict[int, list[int]] = {}
        self._first = self._last = -1
        self._span: tuple[int, int] | None = None
        self._counts: Counter[int] = Counter()
        # By opcode, in the order of the summary section.
        self._summary: dict[int, list[bytes]] = {
            opcode: []
            for opcode in (
                Opcode.SCHEMA,
                Opcode.CHANNEL,
                Opcode.STATISTICS,
                Opcode.CHUNK_INDEX,
                Opcode.ATTACHMENT_INDEX,
                Opcode.METADATA_INDEX,
            )
        }
        self._write(MAGIC)

    def add(self, opcode: int, content: bytes) -> None:
        """Take the next record of the data section."""
        if opcode == MESSAGE_OPCODE:
            self._add_message(content)
            return
        record = PREFIX.pack(opcode, len(content)) + content
        self._close_chunk()
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._summary[opcode].append(record)
        elif opcode == Opcode.ATTACHMENT:
            self._index_attachment(content, len(record))
        elif opcode == Opcode.METADATA:
            metadata = parse(Metadata.read, content, self.key)
            index = MetadataIndex(offset=self._position, length=len(record), name=metadata.name)
            self._summary[Opcode.METADATA_INDEX].append(record_bytes(index))
        self._write(record)

    def add_stretch(self, data: bytes, stretch: Stretch) -> None:
        """Take message records, all of one chunk, of which it is known where they stand."""
        self._close_chunk()
        self._write_chunk(data, stretch.first, stretch.last, stretch.entries)

    def finish(self) -> None:
        """Write what comes behind the data."""
        self._close_chunk()
        self._write_record(DataEnd(data_section_crc=0))
        self._summary[Opcode.STATISTICS].append(record_bytes(self._statistics()))
        start = self._position
        parts: list[bytes] = []
        offsets: list[bytes] = []
        position = start
        for opcode, records in self._summary.items():
            length = sum(map(len, records))
            if records:
                offsets.append(record_bytes(SummaryOffset(opcode, position, length)))
            parts += records
            position += length
        self._write(b"".join([*parts, *offsets]))
        footer = record_bytes(Footer(summary_start=start, summary_offset_start=position, summary_crc=0))
        # The checksum covers the footer too, up to the checksum itself.
        crc = zlib.crc32(b"".join([*parts, *offsets, footer[:-4]]))
        self._write_record(Footer(summary_start=start, summary_offset_start=position, summary_crc=crc))
        self._write(MAGIC)

    def _add_message(self, content: bytes) -> None:
        channel, _, stamp, _ = message_head(content, self.key)
        chunk = self._chunk
        if stamp != self._last or not chunk:
            if len(chunk) > CHUNK_SIZE:
                # Only between stamps: what belongs together is read together.
                self._close_chunk()
            if not chunk:
                self._first = stamp
            self._last = stamp
        if channel not in self._entries:
            self._entries[channel] = []
        self._entries[channel] += (stamp, len(chunk))
        chunk += PREFIX.pack(MESSAGE_OPCODE, len(content))
        chunk += content

    def _close_chunk(self) -> None:
        if not self._chunk:
            return
        entries = {channel: np.array(one, dtype=np.uint64) for channel, one in self._entries.items()}
        self._write_chunk(bytes(self._chunk), self._first, self._last, entries)
        self._chunk.clear()
        self._entries = {}

    def _write_chunk(self, data: bytes, first: int, last: int, entries: Mapping[int, Integers]) -> None:
        """A chunk of message records between two stamps [ns], with stamp and offset of each by channel."""
        packed = self._compressor.compress(data)
        start = self._position
        self._write_record(Chunk("zstd", packed, last, first, zlib.crc32(data), len(data)))
        end, offsets = self._position, {}
        for channel, numbers in entries.items():
            offsets[channel] = self._position
            self._write(_message_index(channel, numbers.tobytes()))
            self._counts[channel] += numbers.size // 2
        index = ChunkIndex(
            chunk_length=end - start,
            chunk_start_offset=start,
            compression="zstd",
            compressed_size=len(packed),
            message_end_time=last,
            message_index_length=self._position - end,
            message_index_offsets=offsets,
            message_start_time=first,
            uncompressed_size=len(data),
        )
        self._summary[Opcode.CHUNK_INDEX].append(record_bytes(index))
        self._span = (first if self._span is None else self._span[0], last)

    def _index_attachment(self, content: bytes, length: int) -> None:
        attachment = parse(Attachment.read, content, self.key)
        index = AttachmentIndex(
            offset=self._position,
            length=length,
            log_time=attachment.log_time,
            create_time=attachment.create_time,
            data_size=len(attachment.data),
            name=attachment.name,
            media_type=attachment.media_type,
        )
        self._summary[Opcode.ATTACHMENT_INDEX].append(record_bytes(index))

    def _statistics(self) -> Statistics:
        first, last = self._span or (0, 0)
        return Statistics(
            attachment_count=len(self._summary[Opcode.ATTACHMENT_INDEX]),
            channel_count=len(self._summary[Opcode.CHANNEL]),
            channel_message_counts=dict(sorted(self._counts.items())),
            chunk_count=len(self._summary[Opcode.CHUNK_INDEX]),
            message_count=sum(self._counts.values()),
            message_end_time=last,
            message_start_time=first,
            metadata_count=len(self._summary[Opcode.METADATA_INDEX]),
            schema_count=len(self._summary[Opcode.SCHEMA]),
        )

    def _write_record(self, record: McapRecord) -> None:
        self._write(record_bytes(record))

    def _write(self, data: bytes) -> None:
        self._stream.write(data)
        self._position += len(data)


def _message_index(channel: int, numbers: bytes) -> bytes:
    """A record that says where in a chunk the messages of a channel are; mcap's own takes a second per million."""
    return _MESSAGE_INDEX.pack(_INDEX_OPCODE, 6 + len(numbers), channel, len(numbers)) + numbers
