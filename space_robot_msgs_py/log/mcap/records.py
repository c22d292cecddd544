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
_MESSAGE_OPCODE = int(Opcode.MESSAGE)


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
    size = MESSAGE.size + len(data)
    return _MESSAGE_RECORD.pack(_MESSAGE_OPCODE, size, channel, sequence, stamp, stamp) + data


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


def scan(stream: IO[bytes], size: int) -> Iterator[tuple[int, bytes]]:
    """Opcode and content of every complete record behind the magic; a file that was truncated just ends earlier.

    Args:
        stream: the file, behind its magic.
        size: of the file [bytes]; no record can be longer, whatever a damaged length says.

    Raises:
        LogError: a record is beyond the limit.
    """
    position = len(MAGIC)
    while position + PREFIX.size <= size:
        prefix = stream.read(PREFIX.size)
        if len(prefix) < PREFIX.size:
            return
        opcode, length = PREFIX.unpack(prefix)
        position += PREFIX.size + length
        if position > size:
            return
        RECORD_BYTES.check(length, "a record", LogError)
        content = stream.read(length)
        if len(content) < length:
            return
        yield opcode, content
        if opcode == Opcode.FOOTER:
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
        if opcode == Opcode.DATA_END:
            return
        if opcode == Opcode.CHUNK:
            yield from walk(unpack_chunk(parse(Chunk.read, content, key), key))
        elif opcode != Opcode.MESSAGE_INDEX:
            yield opcode, content


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
