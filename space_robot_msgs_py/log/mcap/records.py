"""Records of MCAP files (https://mcap.dev/spec): written one by one, and read as far as a file is whole."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from io import BytesIO
from typing import IO, TypeVar

from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Attachment, Chunk, McapRecord, Metadata

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.limits import RECORD_BYTES
from space_robot_msgs_py.log.mcap.chunks import unpack_chunk

MAGIC = b"\x89MCAP0\r\n"
PREFIX = struct.Struct("<BQ")
MESSAGE = struct.Struct("<HIQQ")
_MESSAGE_RECORD = struct.Struct("<BQHIQQ")
# Python 3.11 looks members of an enumeration up in Python.
MESSAGE_OPCODE, _FOOTER = int(Opcode.MESSAGE), int(Opcode.FOOTER)
_NOT_OF_DATA = {int(opcode) for opcode in (Opcode.DATA_END, Opcode.CHUNK, Opcode.MESSAGE_INDEX)}
_HEAD = PREFIX.size
# Bytes of a file that are read at once.
BLOCK = 1 << 18


R = TypeVar("R")


def record_bytes(record: McapRecord) -> bytes:
    """A record as it stands in a file."""
    builder = RecordBuilder()
    record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


def metadata_bytes(name: str, entries: dict[str, str]) -> bytes:
    """A metadata record."""
    return record_bytes(Metadata(name=name, metadata=entries))


def message_bytes(channel: int, sequence: int, stamp: int, data: bytes) -> bytes:
    """A message record, both of whose times are the stamp [ns]; mcap's own class takes twenty times as long."""
    return message_head_bytes(channel, sequence, stamp, len(data)) + data


def message_head_bytes(channel: int, sequence: int, stamp: int, size: int) -> bytes:
    """What stands in front of the data of a message record, of which there are ``size`` bytes."""
    return _MESSAGE_RECORD.pack(MESSAGE_OPCODE, 22 + size, channel, sequence, stamp, stamp)


def message_head(content: bytes, key: str) -> tuple[int, int, int, int]:
    """Channel, sequence number, log time and publish time [ns] of a message record.

    Raises:
        LogError: it is too short for a message; another record may have got its opcode.
    """
    try:
        channel, sequence, stamp, published = MESSAGE.unpack_from(content)
    except struct.error:
        raise LogError("a message is too short", key=key, value=f"{len(content)} bytes") from None
    return channel, sequence, stamp, published


def scan(stream: IO[bytes], size: int, start: int = len(MAGIC)) -> Iterator[tuple[int, bytes]]:
    """Opcode and content of every complete record behind the magic; a file that was truncated just ends earlier.

    Args:
        stream: the file, at ``start``.
        size: of the file [bytes]; no record can be longer, whatever a damaged length says.
        start: where the first record begins.

    Raises:
        LogError: a record is beyond the limit.
    """
    position, most = start, RECORD_BYTES.most
    # What was read of the file and not yet given, from ``start`` on: two reads a record would take as long as all else.
    block, start = b"", 0
    while position + _HEAD <= size:
        if len(block) - start < _HEAD:
            block, start = block[start:] + stream.read(BLOCK), 0
            if len(block) < _HEAD:
                return
        opcode, length = PREFIX.unpack_from(block, start)
        position += _HEAD + length
        if position > size:
            return
        if length > most:
            RECORD_BYTES.check(length, "a record", LogError)
        start += _HEAD
        if (lacking := length - (len(block) - start)) > 0:
            block, start = block[start:] + stream.read(max(lacking, BLOCK)), 0
            if len(block) < length:
                return
        yield opcode, block[start : start + length]
        start += length
        if opcode == _FOOTER:
            return


def parse(read: Callable[[ReadDataStream], R], content: bytes, key: str) -> R:
    """A record from its content.

    Args:
        read: the ``read`` of its class in ``mcap.records``.
        content: what ``scan`` gave.
        key: the file, for error messages.

    Raises:
        LogError: the content is damaged.
    """
    try:
        return read(ReadDataStream(BytesIO(content)))
    except Exception as error:
        # mcap has no common base for what damaged bytes make it raise.
        raise LogError(f"a record is damaged ({type(error).__name__})", key=key) from None


def parse_attachment(content: bytes, key: str) -> Attachment:
    """An attachment, whose checksum no other reader checks.

    Raises:
        LogError: the content is damaged.
    """
    attachment: Attachment = parse(Attachment.read, content, key)
    expected = int.from_bytes(content[-4:], "little")
    if expected and zlib.crc32(content[:-4]) != expected:
        raise LogError(f"the attachment {attachment.name!r} is damaged (checksum)", key=key)
    return attachment


def flatten(records: Iterator[tuple[int, bytes]], key: str) -> Iterator[tuple[int, bytes]]:
    """The records of the data section, with those in chunks in the place of the chunks.

    Raises:
        LogError: a chunk is damaged.
    """
    for opcode, content in records:
        if opcode not in _NOT_OF_DATA:
            yield opcode, content
        elif opcode == Opcode.DATA_END:
            return
        elif opcode == Opcode.CHUNK:
            yield from walk(unpack_chunk(parse(Chunk.read, content, key), key))


def walk(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The complete records in the bytes of a chunk."""
    position = 0
    while position + PREFIX.size <= len(data):
        opcode, length = PREFIX.unpack_from(data, position)
        start = position + PREFIX.size
        position = start + length
        if position > len(data):
            return
        yield opcode, data[start:position]
