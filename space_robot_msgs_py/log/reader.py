"""Reads a log: closed, killed or cut anywhere, up to its last complete record."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata

from space_robot_msgs_py.bounded_files import open_regular, path_kind, short
from space_robot_msgs_py.codec.codecs import TickCodec, decode_string
from space_robot_msgs_py.errors import (
    CommandError,
    InputFileError,
    LayoutError,
    LogError,
    NonFiniteError,
    SpaceRobotError,
)
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.arrays import LogArrays, Row, stack_ticks
from space_robot_msgs_py.log.blocks import BLOCK, Block, BlockStacker
from space_robot_msgs_py.log.directory import BAG_SUFFIX
from space_robot_msgs_py.log.header import METADATA_NAME, LogHeader
from space_robot_msgs_py.log.mcap.records import MAGIC, MESSAGE, flatten, message_head, parse, parse_attachment, scan
from space_robot_msgs_py.log.mcap.summary import summary_in
from space_robot_msgs_py.log.preamble import END_NAME, RECORDED, log_name
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import (
    CONTROLLER_TELEMETRY,
    PLANT_TELEMETRY,
    ROBOT_DESCRIPTION,
    WHEEL_MOMENTUM,
    topics_of,
)

_NAMES = {log_name(topic): topic.name for topic in RECORDED}
# Not of a tick: once per run, or derived from the tick when the log is written.
_BESIDE = frozenset(topic.name for topic in RECORDED if topic.latched or topic.derived)
_ESSENTIAL = frozenset(topic.name for kind in ("state", "reference", "command") for topic in topics_of(kind))
_TELEMETRY = frozenset((CONTROLLER_TELEMETRY.name, PLANT_TELEMETRY.name))


class LogReader:
    """A log on disk; every call reads it again, so a log that is still written can be followed.

    Args:
        path: run directory or .mcap file.

    Attributes:
        path: the .mcap file.
        header: provenance.

    Raises:
        InputFileError: there is no such file, or it is not MCAP.
        LogError: it is not a log of this project, or was truncated within its header.
    """

    def __init__(self, path: StrPath) -> None:
        self.path = _bag_file(Path(path))
        self._key = str(self.path)
        self.header = self._read_header()

    @property
    def end_reason(self) -> str | None:
        """Why the run ended; None if the log was truncated before its end."""
        for opcode, content in self._records():
            if opcode == Opcode.METADATA:
                metadata = parse(Metadata.read, content, self._key)
                if metadata.name == END_NAME:
                    return str(metadata.metadata.get("reason", ""))
        return None

    @property
    def robot_description(self) -> str:
        """The URDF as it was on ``robot_description``; that of the header if the log was truncated before it."""
        for name, _, data in self.messages():
            return decode_string(data) if name == ROBOT_DESCRIPTION.name else self.header.urdf
        return self.header.urdf

    def messages(self) -> Iterator[tuple[str, int, bytes]]:
        """Topic name as in the table, stamp [ns] and bytes of every message, in order.

        Raises:
            LogError: a message is missing between two others or at the end, or a record is damaged.
        """
        with self._open() as stream:
            found: Counter[int] = Counter()
            names: dict[int, str] = {}
            for opcode, content in flatten(_scan(stream), self._key):
                if opcode == Opcode.MESSAGE:
                    channel, sequence, stamp, _ = message_head(content, self._key)
                    if not found:
                        self._check_channels(names.values())
                    if channel not in names or sequence != found[channel]:
                        raise LogError(
                            "a message is missing", key=self._key, value=f"{names.get(channel)} at {stamp} ns"
                        )
                    found[channel] += 1
                    yield names[channel], stamp, content[MESSAGE.size :]
                elif opcode == Opcode.CHANNEL:
                    record = parse(Channel.read, content, self._key)
                    names.setdefault(record.id, _NAMES.get(record.topic, record.topic))
            self._check_counts(stream, found)

    def rows(self) -> Iterator[Row]:
        """Stamp [ns] and messages by topic name of every complete tick, in order.

        A tick is complete with state, reference and command, and with telemetry if the run has any; the momentum of
        the wheels is part of the state where the header names it.
        """
        essential = _ESSENTIAL | {WHEEL_MOMENTUM.name}.intersection(self.header.topics)
        needed: frozenset[str] | None = None
        for (stamp, parts), finished in self._groups():
            if needed is None:
                # The first finished tick tells what telemetry this run has; a cut one must have everything.
                needed = essential | (_TELEMETRY & parts.keys() if finished else _TELEMETRY)
            if parts.keys() >= needed:
                yield stamp, parts

    def stamps(self) -> Iterator[Row]:
        """Stamp [ns] and messages by topic name of every stamp, complete or not, in order; see ``rows``."""
        for row, _ in self._groups():
            yield row

    def ticks(self) -> Iterator[Tick]:
        """Every complete tick that fits the robot, in order; equal to what was written, bit for bit.

        A graph may hear what the plant refuses, such as a command with wrong names: the log has it, a Tick cannot.
        ``unfit`` says which ticks those are.
        """
        for _, _, outcome in self._decoded():
            if isinstance(outcome, Tick):
                yield outcome

    def unfit(self) -> list[str]:
        """One line for each complete tick that is not among ``ticks``: its stamp and what does not fit."""
        return [f"{stamp} ns: {outcome}" for stamp, _, outcome in self._decoded() if not isinstance(outcome, Tick)]

    def arrays(self) -> LogArrays:
        """The same ticks, stacked.

        Raises:
            LogError: the shape of telemetry changes in the course of the log.
        """
        rows = list(self.rows())
        try:
            return stack_ticks(rows, self.header.joint_names, self._key)
        except SpaceRobotError:
            # Cutting all at once is ten times faster than decoding, but all or nothing.
            fitting = [(stamp, parts) for stamp, parts, outcome in self._decoded() if isinstance(outcome, Tick)]
            return stack_ticks(fitting, self.header.joint_names, self._key)

    def blocks(self, size: int = BLOCK) -> Iterator[LogArrays]:
        """The same ticks, stacked some at a time, so that a log of any length can be read; no block is empty.

        Args:
            size: complete ticks of a block; those that do not fit the robot are looked at but not in it.

        Raises:
            LogError: the shape of telemetry changes in the course of the log.
        """
        for block in self.event_blocks(size):
            if block.arrays is not None:
                yield block.arrays

    def event_blocks(self, size: int = BLOCK) -> Iterator[Block]:
        """The same with what happened at the ticks; a block whose ticks all do not fit the robot has no arrays."""
        return BlockStacker(self.header.joint_names, self._key).blocks(self.rows(), size)

    def _decoded(self) -> Iterator[tuple[int, dict[str, bytes], Tick | SpaceRobotError]]:
        codec = TickCodec(self.header.joint_names)
        for stamp, parts in self.rows():
            try:
                yield stamp, parts, codec.decode(parts)
            except (LayoutError, CommandError, NonFiniteError) as error:
                yield stamp, parts, error

    def _groups(self) -> Iterator[tuple[Row, bool]]:
        """Messages of equal stamp, and whether anything follows that proves there are no more of them."""
        stamp, parts = -1, dict[str, bytes]()
        for name, at, data in self.messages():
            if name in _BESIDE:
                continue
            if at != stamp and parts:
                yield (stamp, parts), True
                parts = {}
            stamp = at
            parts[name] = data
        if parts:
            yield (stamp, parts), self.end_reason is not None

    def _check_counts(self, stream: IO[bytes], found: Mapping[int, int]) -> None:
        """A closed log counts its messages at its end: a chunk whose first byte is damaged is no chunk any more."""
        # Of the same file: a log that is closed meanwhile is another one.
        summary = summary_in(stream, self.path)
        missing = summary.missing(found) if summary is not None else {}
        if missing:
            counted = ", ".join(f"{count} on {name}" for name, count in missing.items())
            accepted = "what the log counts at its end"
            raise LogError("messages are missing, the log is damaged", key=self._key, value=counted, accepted=accepted)

    def _check_channels(self, names: Iterable[str]) -> None:
        """Every log has these channels, also empty ones: a name that is missing was damaged."""
        lacking = (_ESSENTIAL | _TELEMETRY).union(self.header.topics).difference(names)
        if lacking:
            raise LogError("topics are missing or damaged", key=self._key, value=", ".join(sorted(lacking)))

    def _read_header(self) -> LogHeader:
        metadata: dict[str, str] | None = None
        attachments: dict[str, bytes] = {}
        for opcode, content in self._records():
            if opcode == Opcode.METADATA and metadata is None:
                record = parse(Metadata.read, content, self._key)
                metadata = record.metadata if record.name == METADATA_NAME else None
            elif opcode == Opcode.ATTACHMENT:
                attachment = parse_attachment(content, self._key)
                # The first of a name counts, as for everything else in the header.
                attachments.setdefault(attachment.name, attachment.data)
            elif opcode in (Opcode.MESSAGE, Opcode.CHUNK, Opcode.SCHEMA):
                break
        if metadata is None:
            raise LogError("an MCAP file, but not a run log, or truncated within its first record", key=self._key)
        return LogHeader.of(metadata, attachments, self._key)

    def _records(self) -> Iterator[tuple[int, bytes]]:
        with self._open() as stream:
            yield from _scan(stream)

    @contextmanager
    def _open(self) -> Iterator[IO[bytes]]:
        with open_regular(self.path, self._key) as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                raise InputFileError("not an MCAP file", key=self._key)
            yield stream


def _scan(stream: IO[bytes]) -> Iterator[tuple[int, bytes]]:
    return scan(stream, os.fstat(stream.fileno()).st_size)


def _bag_file(path: Path) -> Path:
    kind = path_kind(path)
    if kind == "directory":
        found = sorted(path.glob("*.mcap"))
        # A bag that was renamed or copied by another tool has no number.
        bags = [one for one in found if one.name.endswith(BAG_SUFFIX)] or found
        if len(bags) != 1:
            value = f"{len(bags)} files *.mcap"
            raise InputFileError("not a run directory", key=short(path), value=value, accepted="one of them")
        return bags[0]
    if kind == "none":
        raise InputFileError("no such file", key=short(path), accepted="a run directory or an .mcap file")
    return path
