"""Bags that rosbags reads for us: what is bounded before it opens them, and while it unpacks them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

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


def unpacker(reader: Any) -> Callable[[bytes], bytes]:
    """What makes a message of what a reader of rosbags gives.

    rosbags unpacks messages that rosbag2 compressed one by one to whatever size they say; here it takes them as
    not compressed, and they are unpacked up to a limit.

    Args:
        reader: an open AnyReader.
    """
    packed = False
    for one in reader.readers:
        storage: Any = getattr(one, "storage", None)
        metadata: Any = getattr(storage, "metadata", None)
        if getattr(metadata, "compression_mode", None) == "message":
            storage.metadata = metadata._replace(compression_mode=None)
            packed = True
    return _unpack if packed else lambda raw: raw


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
