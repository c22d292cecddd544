"""Bags that rosbags reads for us: what is bounded before it opens them, and while it unpacks them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import zstandard

from space_robot_msgs_py.bounded_files import is_directory, is_file, open_regular, read_text, short
from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.errors import InputFileError, SpaceRobotError
from space_robot_msgs_py.limits import METADATA_BYTES, MIB, RECORD_BYTES
from space_robot_msgs_py.log.directory import METADATA_FILE
from space_robot_msgs_py.log.mcap.chunks import MAX_RATIO, MAX_UNPACKED


def check_before_reading(place: Path) -> None:
    """Refuse what rosbags would read or unpack without a bound.

    Args:
        place: a bag directory or one of its files.

    Raises:
        InputFileError: a file of it is none, its description is none, or it would unpack to more than it may.
    """
    files = [place]
    if is_directory(place):
        files = [file for suffix in ("mcap", "db3", "zstd") for file in sorted(place.glob(f"*.{suffix}"))]
        try:
            load_yaml(read_text(place / METADATA_FILE, METADATA_BYTES), METADATA_FILE, METADATA_BYTES)
        except SpaceRobotError as error:
            raise InputFileError(f"cannot be read as a bag: {error}", key=short(place)) from None
    for file in files:
        if not is_file(file):
            raise InputFileError("is no regular file", key=short(file), accepted="a file, not a pipe or a device")
        if file.suffix == ".zstd":
            _check_unpacked(file)


class ForeignMessage(NamedTuple):
    """One message that rosbags read: topic, type, encoding, time of the recording [ns], bytes."""

    topic: str
    type: str
    encoding: str
    time: int
    data: bytes


def foreign_messages(place: Path) -> Iterator[ForeignMessage]:
    """Every message of a bag that rosbags can read, file by file.

    The files are asked themselves: where ``metadata.yaml`` says something else of a topic than its file does, such as
    another quality of service, rosbags leaves out the messages. And it unpacks messages that rosbag2 compressed one by
    one to whatever size they say; here they are unpacked up to a limit.

    Args:
        place: a bag directory or one of its files, see ``check_before_reading``.

    Raises:
        Exception: of many kinds, whatever a corrupted bag makes rosbags, SQLite and the decompressors raise.
    """
    from rosbags.rosbag2 import Reader

    with Reader(place) as reader:
        whole: Any = reader.storage
        unpack = _unpack if reader.compression_mode == "message" else _same
        for storage in getattr(whole, "storages", None) or [whole]:
            for connection, time, raw in storage.messages(list(storage.connections)):
                encoding = connection.ext.serialization_format
                yield ForeignMessage(connection.topic, connection.msgtype, encoding, time, unpack(bytes(raw)))


def _same(raw: bytes) -> bytes:
    return raw


def _unpack(packed: bytes) -> bytes:
    said = zstandard.get_frame_parameters(packed).content_size
    most = min(RECORD_BYTES.most, max(MIB, MAX_RATIO * len(packed)))
    if said != zstandard.CONTENTSIZE_UNKNOWN and said > most:
        raise RECORD_BYTES.exceeded("a compressed message", said, InputFileError)
    return zstandard.decompress(packed, max_output_size=most)


def _check_unpacked(file: Path) -> None:
    """Unpack a file to nowhere: rosbags does it to the disk, as far as there is room."""
    total = 0
    with open_regular(file) as stream:
        most = max(MAX_UNPACKED, MAX_RATIO * file.stat().st_size)
        try:
            unpacked = zstandard.ZstdDecompressor().stream_reader(stream, read_across_frames=True)
            while part := unpacked.read(MIB):
                total += len(part)
                if total > most:
                    accepted = f"up to {most} bytes, {MAX_RATIO} times its size"
                    raise InputFileError("unpacks to more than any bag", key=short(file), accepted=accepted)
        except zstandard.ZstdError as error:
            raise InputFileError(f"cannot be read as a bag: {error}", key=short(file)) from None
