"""A damaged byte of the structure of a log never makes ticks vanish without a word."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from mcap.opcode import Opcode
from mcap.records import Footer

from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.log.bag import Bag, BagMessage, Missing, intact
from space_robot_msgs_py.log.mcap import index
from space_robot_msgs_py.log.mcap.records import MAGIC, PREFIX, record_bytes, scan
from space_robot_msgs_py.log.mcap.summary import read_summary
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values

COUNT = 9
# Every opcode there is, and two that are none.
OPCODES = (*range(1, 16), 0, 0x86)
# Of the eight bytes of a length; the high ones make it longer than the file.
LENGTH_FLIPS = tuple((byte, bit) for byte in (0, 1, 2, 7) for bit in (0, 6))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A closed log with several chunks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(index, "CHUNK_SIZE", 4000)
        sink = LogSink(tmp_path_factory.mktemp("flips") / "run", values.HEADER)
        for tick in values.run_ticks(COUNT):
            sink.record(tick)
        sink.close("completed")
    return sink.writer.path.read_bytes()


def places(data: bytes) -> list[tuple[int, int]]:
    """Opcode and offset of the first and the last record of each kind."""
    stream, offset = io.BytesIO(data), len(MAGIC)
    stream.seek(offset)
    found: dict[int, list[int]] = {}
    for opcode, content in scan(stream, len(data)):
        found.setdefault(opcode, []).append(offset)
        offset += PREFIX.size + len(content)
    assert len(found[Opcode.CHUNK]) > 2
    return [(opcode, at) for opcode, offsets in found.items() for at in dict.fromkeys((offsets[0], offsets[-1]))]


def flipped(data: bytes) -> list[tuple[str, bytes]]:
    """The log with another opcode, or another length, of one record."""
    spoiled = []
    for opcode, at in places(data):
        for other in OPCODES:
            if other != opcode:
                spoiled.append((f"opcode {opcode} at {at} is {other}", data[:at] + bytes([other]) + data[at + 1 :]))
        for byte, bit in LENGTH_FLIPS:
            changed = bytearray(data)
            changed[at + 1 + byte] ^= 1 << bit
            spoiled.append((f"length of {opcode} at {at}, byte {byte} bit {bit}", bytes(changed)))
    return spoiled


def test_no_damaged_opcode_or_length_loses_ticks_without_an_error(log: bytes, tmp_path: Path) -> None:
    """Whatever opcode or length of a closed log is damaged, a reader gives every tick or raises one line."""
    path, lines = tmp_path / "bad_0.mcap", list[str]()
    for what, data in flipped(log):
        path.write_bytes(data)
        try:
            count = sum(1 for _ in LogReader(path).ticks())
        except SpaceRobotError as error:
            lines.append(str(error))
        else:
            assert count == COUNT, what
    assert not [line for line in lines if "\n" in line]
    assert len(lines) > 100


def test_no_damaged_opcode_or_length_hides_that_messages_are_missing(log: bytes, tmp_path: Path) -> None:
    """A reader of bags gives every message, or says what is damaged or missing; one that needs all raises."""
    path = tmp_path / "bad_0.mcap"
    path.write_bytes(log)
    whole = {(item.topic, item.time, item.data) for item in Bag(path).messages() if isinstance(item, BagMessage)}
    for what, data in flipped(log):
        path.write_bytes(data)
        items = list(Bag(path).messages())
        messages = [item for item in items if isinstance(item, BagMessage)]
        read = {(item.topic, item.time, item.data) for item in messages}
        assert whole <= read or len(messages) < len(items), what
        if any(isinstance(item, Missing) for item in items):
            with pytest.raises(LogError, match=r"missing|damaged"):
                list(intact(Bag(path).messages(), str(path)))


def test_a_chunk_that_is_none_any_more_is_named_with_what_it_held(log: bytes, tmp_path: Path) -> None:
    """With the opcode of any chunk damaged the messages of its topics are counted as missing."""
    path = tmp_path / "bad_0.mcap"
    path.write_bytes(log)
    summary = read_summary(path)
    assert summary is not None
    assert sum(summary.counts.values()) == sum(isinstance(item, BagMessage) for item in Bag(path).messages())
    for opcode, at in places(log):
        if opcode == Opcode.CHUNK:
            path.write_bytes(log[:at] + bytes([Opcode.SUMMARY_OFFSET]) + log[at + 1 :])
            missing = [item for item in Bag(path).messages() if isinstance(item, Missing)]
            assert {"/base/odom", "/joint_states"} <= {item.topic for item in missing}
            with pytest.raises(LogError, match="missing"):
                list(LogReader(path).messages())


def test_a_damaged_summary_is_not_believed(log: bytes, tmp_path: Path) -> None:
    """With any byte of the summary changed there is none, and every tick is read all the same."""
    path = tmp_path / "bad_0.mcap"
    start = next(at for opcode, at in places(log) if opcode == Opcode.DATA_END) + PREFIX.size + 4
    for at in range(start, len(log) - 1, 11):
        changed = bytearray(log)
        changed[at] ^= 0x10
        path.write_bytes(changed)
        assert read_summary(path) is None
        if at % 5 == 0:
            assert sum(1 for _ in LogReader(path).ticks()) == COUNT


@pytest.mark.parametrize(
    "hostile",
    [b"", b"\0" * 30, b"\xff" * 36, b"\0" * 32 + b"\x0a\0\0\0" + b"\x02\0" + b"\xff" * 8],
    ids=["empty", "short", "long", "far"],
)
def test_an_index_without_a_checksum_may_say_anything(log: bytes, tmp_path: Path, hostile: bytes) -> None:
    """Chunk indexes that are too short or lead out of the file are one error; the messages are read without them."""
    section = read_section(log)
    parts = [PREFIX.pack(opcode, len(content)) + content for opcode, content in section if opcode != Opcode.CHUNK_INDEX]
    parts.append(PREFIX.pack(Opcode.CHUNK_INDEX, len(hostile)) + hostile)
    start = len(log) - sum(PREFIX.size + len(content) for _, content in section) - PREFIX.size - 20 - len(MAGIC)
    path = tmp_path / "bad_0.mcap"
    footer = record_bytes(Footer(summary_start=start, summary_offset_start=0, summary_crc=0))
    path.write_bytes(log[:start] + b"".join(parts) + footer + MAGIC)
    summary = read_summary(path)
    assert summary is not None
    with pytest.raises(LogError, match="index is damaged"):
        summary.topics()
    assert sum(1 for _ in LogReader(path).ticks()) == COUNT


def read_section(data: bytes) -> list[tuple[int, bytes]]:
    """The records of the summary."""
    stream = io.BytesIO(data)
    stream.seek(len(MAGIC))
    records = list(scan(stream, len(data)))
    end = next(number for number, (opcode, _) in enumerate(records) if opcode == Opcode.DATA_END)
    return records[end + 1 : -1]
