"""What is in a chunk of an MCAP file, its checksum checked, and nothing allocated that a damaged length asks for."""

from __future__ import annotations

import zlib
from io import BytesIO

import lz4.frame
import zstandard
from mcap.records import Chunk

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.limits import CHUNK_BYTES

# A chunk may be that large, or that many times its compressed size; a length beyond is damage, not data.
MAX_UNPACKED = 1 << 24
MAX_RATIO = 256


def unpack_chunk(chunk: Chunk, key: str) -> bytes:
    """The records in a chunk.

    Args:
        chunk: as it stands in the file.
        key: the file, for error messages.

    Raises:
        LogError: it is damaged, compressed in an unknown way, or says that it is absurdly large.
    """
    size, most = chunk.uncompressed_size, _most(chunk)
    if size > most:
        raise LogError("a chunk is damaged (size)", key=key, value=size, accepted=f"up to {most} bytes")
    data = _unpack(chunk, size, key)
    if len(data) != size:
        raise LogError("a chunk is damaged (size)", key=key, value=len(data), accepted=f"{size} bytes")
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise LogError("a chunk is damaged (checksum)", key=key)
    return data


def _most(chunk: Chunk) -> int:
    """How large a chunk may be, unpacked."""
    return min(CHUNK_BYTES.most, max(MAX_UNPACKED, MAX_RATIO * len(chunk.data)))


def _unpack(chunk: Chunk, size: int, key: str) -> bytes:
    try:
        if chunk.compression == "":
            return bytes(chunk.data)
        if chunk.compression == "zstd":
            return _unpack_zstd(chunk.data, size)
        if chunk.compression == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size))
    except (zstandard.ZstdError, RuntimeError, EOFError, MemoryError) as error:
        raise LogError(f"a chunk is damaged ({error})", key=key) from None
    raise LogError("unknown compression", key=key, value=chunk.compression, accepted="zstd, lz4 or none")


def _unpack_zstd(packed: bytes, size: int) -> bytes:
    # The frame has a length of its own, by which the library allocates; it may be damaged as well.
    said = zstandard.get_frame_parameters(packed).content_size
    if said not in (size, zstandard.CONTENTSIZE_UNKNOWN):
        raise zstandard.ZstdError(f"its frame says {said} bytes, its record {size}")
    return zstandard.decompress(packed, max_output_size=size)


def unpack_beginning(chunk: Chunk) -> bytes:
    """What can be unpacked of a chunk that was truncated; nothing is checked, for its checksum is that of the whole."""
    packed = chunk.data
    most = min(chunk.uncompressed_size, _most(chunk))
    try:
        if chunk.compression == "zstd":
            return zstandard.ZstdDecompressor().stream_reader(BytesIO(packed)).read(most)
        if chunk.compression == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=most))
    except (zstandard.ZstdError, RuntimeError, EOFError, MemoryError):
        return b""
    return bytes(packed) if chunk.compression == "" else b""
