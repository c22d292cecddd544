"""Reads whatever is left of an MCAP file: beyond damage it looks for the next record that makes sense."""

from __future__ import annotations

import mmap
import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Header, Metadata, Schema, Statistics

from space_robot_msgs_py.bounded_files import open_regular
from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.limits import DAMAGES, RECORD_BYTES
from space_robot_msgs_py.log.mcap.chunks import unpack_beginning, unpack_chunk
from space_robot_msgs_py.log.mcap.records import MAGIC, MESSAGE, PREFIX, parse, parse_attachment, walk

_OPCODES = frozenset(int(opcode) for opcode in Opcode)
# An opcode and a length below 4 GB: in compressed bytes that is one in 2^36, so looking for it is fast.
_CANDIDATE = re.compile(rb"(?=[\x01-\x0f][\x00-\xff]{4}\x00{4})", re.DOTALL)
# So many records in a row have to make sense before the place is believed to be the start of one.
_CHAIN = 3
_MIN_SIZE = {int(Opcode.MESSAGE): MESSAGE.size, int(Opcode.CHUNK): 40, int(Opcode.FOOTER): 20}
_PARSED: dict[int, Callable[[ReadDataStream], object]] = {
    int(Opcode.HEADER): Header.read,
    int(Opcode.SCHEMA): Schema.read,
    int(Opcode.CHANNEL): Channel.read,
    int(Opcode.METADATA): Metadata.read,
    int(Opcode.STATISTICS): Statistics.read,
}
CUT = "cut within a record"


@dataclass(frozen=True, slots=True)
class Damage:
    """Bytes of a file that are lost.

    Attributes:
        offset: where they begin.
        size: how many there are.
        what: what is wrong with them.
    """

    offset: int
    size: int
    what: str

    @property
    def cut(self) -> bool:
        """It is the end that is missing."""
        return self.what == CUT


class Record(NamedTuple):
    """One record; those in chunks have the place of their chunk."""

    opcode: int
    content: bytes
    offset: int


def salvage(path: Path) -> Iterator[Record | Damage]:
    """Every record of the data section that can be read, those in chunks one by one, and the damage in between.

    The file is mapped, not read: what it takes is one chunk.

    Args:
        path: an MCAP file, whole, truncated or corrupted.

    Raises:
        InputFileError: it cannot be read, or not one record of MCAP is in it.
    """
    with open_regular(path) as stream:
        try:
            data = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
        except ValueError:
            raise InputFileError("is empty", key=str(path), accepted="an MCAP file") from None
        with data:
            yield from _open(data, str(path))


def _open(data: mmap.mmap, key: str) -> Iterator[Record | Damage]:
    start = len(MAGIC)
    if data[:start] != MAGIC:
        found = _next_place(data, 0)
        if found == len(data):
            raise InputFileError("not an MCAP file", key=key)
        yield Damage(0, found, "the beginning is not that of an MCAP file")
        start = found
    damages = 0
    for item in _records(data, start):
        if isinstance(item, Damage):
            damages += 1
            if damages > DAMAGES.most:
                what = f"damaged at more than {DAMAGES.most} places before (limit {DAMAGES.name}): not looked at"
                yield Damage(item.offset, len(data) - item.offset, what)
                return
            if item.cut and data[item.offset] == Opcode.CHUNK:
                yield from _beginning(data, item.offset, key)
            yield item
        elif item.opcode == Opcode.CHUNK:
            yield from _chunk(item, key)
        else:
            yield _checked(item, key)


def _records(data: mmap.mmap, position: int) -> Iterator[Record | Damage]:
    while position < len(data):
        stop = _end(data, position)
        if stop is None:
            found = _next_place(data, position + 1)
            what = CUT if found == len(data) else "not a record"
            yield Damage(position, found - position, what)
            position = found
            continue
        record = Record(data[position], data[position + PREFIX.size : stop], position)
        yield record
        if record.opcode == Opcode.FOOTER:
            return
        position = stop


def _end(data: mmap.mmap, position: int) -> int | None:
    """Where the record at that place ends; None if there is none."""
    if position + PREFIX.size > len(data):
        return None
    opcode, length = PREFIX.unpack_from(data, position)
    stop = position + PREFIX.size + length
    if opcode not in _OPCODES or stop > len(data) or not _MIN_SIZE.get(opcode, 0) <= length <= RECORD_BYTES.most:
        return None
    # What follows begins with an opcode or is the end; else the length is wrong, and would swallow good records.
    if stop < len(data) and opcode != Opcode.FOOTER and data[stop] not in _OPCODES:
        return None
    return int(stop)


def _next_place(data: mmap.mmap, position: int) -> int:
    """The next place at which records follow each other; the end of the file if there is none."""
    for match in _CANDIDATE.finditer(data, position):
        place: int | None = match.start()
        for _ in range(_CHAIN):
            place = _end(data, place) if place is not None else None
            if place is None or place == len(data):
                break
        if place is not None:
            return match.start()
    return len(data)


def _chunk(record: Record, key: str) -> Iterator[Record | Damage]:
    try:
        inside = unpack_chunk(parse(Chunk.read, record.content, key), key)
        yield from (_checked(Record(opcode, content, record.offset), key) for opcode, content in walk(inside))
    except (LogError, struct.error) as error:
        yield _damage(record, error)


def _beginning(data: mmap.mmap, offset: int, key: str) -> Iterator[Record | Damage]:
    """The records at the beginning of a chunk whose end is missing."""
    try:
        # Its data has a length in front of it that is that of the whole.
        chunk = parse(Chunk.read, data[offset + PREFIX.size :], key)
    except LogError:
        return
    yield from (_checked(Record(opcode, content, offset), key) for opcode, content in walk(unpack_beginning(chunk)))


def _checked(record: Record, key: str) -> Record | Damage:
    """The record, or damage where it cannot be what its opcode says."""
    try:
        if record.opcode in _PARSED:
            parse(_PARSED[record.opcode], record.content, key)
        elif record.opcode == Opcode.ATTACHMENT:
            parse_attachment(record.content, key)
        elif record.opcode == Opcode.MESSAGE and len(record.content) < MESSAGE.size:
            raise LogError("a message is too short")
    except LogError as error:
        return _damage(record, error)
    return record


def _damage(record: Record, error: Exception) -> Damage:
    what = error.message if isinstance(error, LogError) else "a chunk is damaged"
    return Damage(record.offset, PREFIX.size + len(record.content), what)
