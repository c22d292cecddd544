"""The end of a log: the reason, the index, the description; also of a log whose writer died."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import IO

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.directory import METADATA_FILE, TEMPORARY, metadata_yaml, recorded_topics
from space_robot_msgs_py.log.mcap.index import write_indexed
from space_robot_msgs_py.log.mcap.positions import Positions
from space_robot_msgs_py.log.mcap.records import MAGIC, MESSAGE, PREFIX, metadata_bytes, parse, scan
from space_robot_msgs_py.log.preamble import ALWAYS, CHANNELS, END_NAME, RECORDED
from space_robot_msgs_py.log.run_directory import RunDirectory

_BY_ID = {CHANNELS[topic.name]: topic for topic in RECORDED}


@dataclass(slots=True)
class Written:
    """What a plain log file holds.

    Attributes:
        size: of its complete records [bytes].
        counts: messages by topic name, for each topic with a channel.
        last: newest stamp [ns]; -1: none.
        ticks: stamps, the description apart.
        positions: of the messages, where they were noted.
    """

    size: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    last: int = -1
    ticks: int = 0
    positions: Positions = field(default_factory=Positions)


def write_all(stream: IO[bytes], data: bytes) -> None:
    """Write to an unbuffered file; it may take less than all at a time."""
    view = memoryview(data)
    while view:
        view = view[stream.write(view) :]


def append_end(stream: IO[bytes], written: Written, reason: str) -> None:
    """Write the reason of the end behind the complete records, in place of whatever stands there."""
    os.ftruncate(stream.fileno(), written.size)
    stream.seek(written.size)
    write_all(stream, metadata_bytes(END_NAME, {"reason": reason, "ticks": str(written.ticks)}))


def finish_bag(
    place: RunDirectory, stream: IO[bytes], written: Written, reason: str, custom: Mapping[str, str]
) -> None:
    """Write the end, index the file and describe it.

    A kill at any time in here leaves a readable file: the indexed one replaces the plain one at once.

    Args:
        place: run directory.
        stream: its plain bag file, unbuffered.
        written: to it.
        reason: of the end.
        custom: remarks for ``metadata.yaml``.

    Raises:
        OSError: the disk refuses; the plain file stays.
    """
    append_end(stream, written, reason)
    topics, remarks = recorded_topics(written.counts), {**custom, "end_reason": reason}
    temporaries = {METADATA_FILE + TEMPORARY: METADATA_FILE, place.bag.name + TEMPORARY: place.bag.name}
    described, indexed = temporaries
    try:
        with place.create(described) as outgoing:
            outgoing.write(metadata_yaml(place.bag.name, topics, last_stamp=max(written.last, 0), custom=remarks))
            outgoing.flush()
            os.fsync(outgoing.fileno())
        with place.create(indexed) as outgoing:
            incoming = io.BufferedReader(stream)  # type: ignore[type-var]
            try:
                write_indexed(incoming, outgoing, str(place.bag), written.positions)
            finally:
                incoming.detach()
        for source, target in temporaries.items():
            place.replace(source, target)
    except BaseException:
        for name in temporaries:
            with suppress(OSError):
                place.remove(name)
        raise


def close_log_of_dead_writer(place: RunDirectory, reason: str, custom: Mapping[str, str]) -> bool:
    """Give the log of a writer that died its reason, an index and a description; False where there is no log.

    Args:
        place: run directory; no process writes to it any more.
        reason: of the end.
        custom: remarks for ``metadata.yaml``.

    Raises:
        LogError: the disk refuses; what was written stays.
    """
    try:
        with place.open(place.bag.name) as stream:
            written = _read_back(stream, str(place.bag))
            if written is None:
                return False
            with io.FileIO(os.dup(stream.fileno()), "r+b") as plain:
                finish_bag(place, plain, written, reason, custom)
    except FileNotFoundError:
        return False
    except LogError:
        raise
    except OSError as error:
        raise LogError(f"the log cannot be closed: {error.strerror or error}", key=str(place.bag)) from None
    return True


def _read_back(stream: IO[bytes], key: str) -> Written | None:
    """What is in a plain log; None where it has its end already, or was truncated within its head."""
    if stream.read(len(MAGIC)) != MAGIC:
        return None
    written = Written(size=len(MAGIC))
    for opcode, content in scan(stream, os.fstat(stream.fileno()).st_size):
        if opcode == Opcode.METADATA and parse(Metadata.read, content, key).name == END_NAME:
            return None
        if opcode == Opcode.MESSAGE:
            _count(written, content)
        if opcode == Opcode.CHANNEL:
            written.counts[_BY_ID[parse(Channel.read, content, key).id].name] = 0
        written.size += PREFIX.size + len(content)
    return written if written.counts.keys() >= ALWAYS else None


def _count(written: Written, content: bytes) -> None:
    channel, _, stamp, _ = MESSAGE.unpack_from(content)
    topic = _BY_ID[channel]
    written.counts[topic.name] += 1
    if stamp > written.last and not topic.latched:
        written.last = stamp
        written.ticks += 1
