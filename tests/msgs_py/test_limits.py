"""What is too large, too deep or without an end is refused in one line that names the limit."""

from __future__ import annotations

import os
import re
import zlib
from pathlib import Path

import numpy as np
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk

from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_description.load import load_robot
from space_robot_description.urdf import parse_urdf
from space_robot_description.validation import parse_yaml, parse_yaml_text
from space_robot_msgs_py.bounded_files import read_text
from space_robot_msgs_py.codec import topic_bytes
from space_robot_msgs_py.codec.codecs import CommandCodec, TelemetryCodec, TopicBytes, decode_string, encode_string
from space_robot_msgs_py.errors import InputFileError, LayoutError, LogError, SpaceRobotError, SpecError
from space_robot_msgs_py.foreign_files import check_before_reading
from space_robot_msgs_py.interfaces import Telemetry
from space_robot_msgs_py.limits import LIMITS, MESSAGE_SLACK, STRING_BYTES, YAML_BYTES
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.mcap.chunks import unpack_chunk
from space_robot_msgs_py.log.mcap.records import MAGIC, PREFIX, record_bytes
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import BASE_ODOM, CONTROLLER_TELEMETRY, JOINT_COMMAND, JOINT_STATES
from space_robot_msgs_py.urdf_frames import read_frames
from space_robot_studies.campaign.directory import campaign_rows
from tests.support.bombs import BAD_XML, BAD_YAML, alias_bomb


@pytest.mark.parametrize(("text", "said"), BAD_YAML.values(), ids=BAD_YAML)
def test_yaml_without_a_bound_is_refused(text: str, said: str) -> None:
    """Bombs of aliases, depth, digits and everything that is no plain data is one short line."""
    with pytest.raises(SpecError) as refusal:
        parse_yaml_text(text, "f.yaml")
    assert said in str(refusal.value)
    assert len(str(refusal.value)) < 300


def test_aliases_and_merges_that_stay_small_are_plain_data() -> None:
    """Anchors, aliases and merges are written out; what is merged gives way to what stands beside it."""
    text = "one: &one {a: 1, b: 2}\ntwo: {<<: *one, b: 3}\nlist: [*one, *one]"
    one = {"a": 1, "b": 2}
    assert parse_yaml_text(text, "f") == {"one": one, "two": {"a": 1, "b": 3}, "list": [one, one]}


def test_files_are_read_up_to_their_limit(tmp_path: Path) -> None:
    """A file beyond the limit, one without an end, a pipe and a directory are named; nothing waits."""
    path = tmp_path / "large.yaml"
    with path.open("wb") as stream:
        stream.write(b"title: ")
        stream.truncate(YAML_BYTES.most + 10)
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "zero.yaml").symlink_to("/dev/zero")
    for name, said in {
        "large.yaml": "YAML_BYTES",
        "pipe.yaml": "regular",
        "zero.yaml": "regular",
        ".": "regular",
    }.items():
        with pytest.raises(InputFileError, match=said):
            read_text(tmp_path / name, YAML_BYTES)
    for name in ("pipe.yaml", "zero.yaml"):
        with pytest.raises(SpaceRobotError, match="no such robot file"):
            load_robot(tmp_path / name)
        with pytest.raises(SpaceRobotError, match="regular"):
            parse_yaml(tmp_path / name)


@pytest.mark.parametrize("length", [1_001, 5_000_000])
def test_a_title_is_one_line(length: int) -> None:
    """A title beyond its limit is refused with the number of characters that is accepted, not with the title."""
    data = {"title": "x" * length, "robot": "mini", "control_period": 0.1, "duration": 1.0}
    with pytest.raises(SpecError, match="at most 1000 characters") as refusal:
        experiment_from(data | {"reference": {"kind": "step"}}, "f")
    assert len(str(refusal.value)) < 300


@pytest.mark.parametrize(("text", "said"), BAD_XML.values(), ids=BAD_XML)
def test_a_urdf_without_a_bound_is_refused(text: str, said: str) -> None:
    """Entities, depth, length and number of elements are bounded, in every reader of a URDF."""
    with pytest.raises(SpecError, match=said) as refusal:
        parse_urdf(text, "urdf")
    assert len(str(refusal.value)) < 400
    assert said in ("NAME_LENGTH", "JOINTS") or read_frames(text) == (None, {})


NAMES = ("a", "b")


@pytest.mark.parametrize("topic", [BASE_ODOM, JOINT_STATES, JOINT_COMMAND])
def test_a_message_far_longer_than_the_robot_is_not_decoded(
    topic: topic_bytes.Topic, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its size is known from the joint names: a longer one is refused without a look into it, and nothing is kept."""
    monkeypatch.setattr(topic_bytes, "canonical_message", lambda *_: pytest.fail("it was decoded"))
    raw = bytes.fromhex("00010000") + bytes(8_000_000)
    with pytest.raises(LayoutError, match=MESSAGE_SLACK.name):
        TopicBytes(NAMES).read(topic, raw)
    if topic is JOINT_COMMAND:
        with pytest.raises(LayoutError, match=MESSAGE_SLACK.name):
            CommandCodec(NAMES).peek(1, raw)


def test_telemetry_and_texts_have_an_end() -> None:
    """Blocks of telemetry are counted before they are read, and so are the bytes of a text."""
    codec, many = TelemetryCodec(CONTROLLER_TELEMETRY), 1_200
    (raw,) = codec.encode(Telemetry(0, tuple(map(str, range(many))), (1,) * many, np.zeros(many)))
    with pytest.raises(LayoutError, match="TELEMETRY_BLOCKS"):
        TelemetryCodec(CONTROLLER_TELEMETRY).decode((raw,))
    (raw,) = codec.encode(Telemetry(0, ("x",), (200_000,), np.zeros(200_000)))
    with pytest.raises(LayoutError, match="TELEMETRY_BYTES"):
        TelemetryCodec(CONTROLLER_TELEMETRY).decode((raw,))
    with pytest.raises(LayoutError, match=STRING_BYTES.name):
        decode_string(encode_string("x" * STRING_BYTES.most))


@pytest.mark.parametrize("compression", ["zstd", "lz4", ""])
def test_a_chunk_that_says_it_is_huge_is_damage(compression: str) -> None:
    """The size a chunk declares is bounded by its own size and by a limit, before anything is unpacked."""
    packed = zstandard.compress(bytes(1_000_000)) if compression == "zstd" else bytes(1000)
    for size in (1 << 62, 1 << 34, 300 << 20):
        chunk = Chunk(compression, packed, 0, 0, 0, size)
        with pytest.raises(LogError, match="size"):
            unpack_chunk(chunk, "f")


def test_a_chunk_that_is_more_than_it_says_is_damage() -> None:
    """What is unpacked is never more than what was declared."""
    data = bytes(30_000_000)
    chunk = Chunk("zstd", zstandard.compress(data), 0, 0, zlib.crc32(data), 1000)
    with pytest.raises(LogError, match="damaged"):
        unpack_chunk(chunk, "f")


def test_a_record_of_any_length_costs_nothing(tmp_path: Path) -> None:
    """The length of a record is looked at before it is read, in a file that has holes of that size, too."""
    path = tmp_path / "sparse_0.mcap"
    with path.open("wb") as stream:
        stream.write(MAGIC + PREFIX.pack(Opcode.METADATA, 1 << 36))
        stream.truncate(1 << 37)
    with pytest.raises(LogError, match="RECORD_BYTES"):
        LogReader(path)


def test_a_file_that_is_nothing_but_damage_is_given_up(tmp_path: Path) -> None:
    """After so many damaged places the rest is one of them: the list of them does not fill the memory."""
    good = record_bytes(Chunk("", b"", 0, 0, 1, 0))
    bad = bytes([0x0C]) * 3
    path = tmp_path / "many.mcap"
    path.write_bytes(MAGIC + (bad + good * 4) * 5_000)
    damage = list(Bag(path).messages())
    assert len(damage) < 10_000
    assert "DAMAGES" in damage[-1].what  # type: ignore[union-attr]


def test_a_bag_that_others_unpack_is_looked_at_first(tmp_path: Path) -> None:
    """A description without a bound, a pipe for a file and a bomb of zstd are refused before rosbags opens them."""
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text(alias_bomb())
    (bag / "bag_0.db3").write_bytes(b"")
    with pytest.raises(InputFileError, match="YAML_NODES"):
        check_before_reading(bag)
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information: {}")
    os.mkfifo(bag / "bag_1.db3")
    with pytest.raises(InputFileError, match="regular"):
        check_before_reading(bag)
    (bag / "bag_1.db3").unlink()
    (bag / "bag_0.db3.zstd").write_bytes(zstandard.compress(bytes(40_000_000)))
    with pytest.raises(InputFileError, match="unpacks to more"):
        check_before_reading(bag)


def test_rows_of_a_campaign_may_be_anything(tmp_path: Path) -> None:
    """A row that is none is named with its line in the file, whatever is wrong with it."""
    good = '{"versions": {}}\n'
    columns = '"run": 0, "seed": 0, "end_reason": "", "completed": true, "passed": true, "failed": "", "ticks": 1'
    rows = {
        "no row": "[]",
        "nested": "[" * 100_000,
        "a text for a number": f'{{"index": "../..", "columns": {{"index": 0, {columns}}}}}',
        "not a number": f'{{"index": 0, "columns": {{"index": 0, "x": NaN, {columns}}}}}',
        "columns missing": '{"index": 0, "columns": {}}',
        "another case": f'{{"index": 1, "columns": {{"index": 0, {columns}}}}}',
        "a list": f'{{"index": 0, "columns": {{"index": 0, "x": [1], {columns}}}}}',
    }
    whole = f'{{"index": 0, "columns": {{"index": 0, {columns}}}}}'
    for row in rows.values():
        for line, text in ((2, row), (3, f"{whole}\n{row}"), (2, f"{row}\n{whole}")):
            (tmp_path / "rows.jsonl").write_text(f"{good}{text}\n")
            with pytest.raises(
                LogError, match=rf"^{re.escape(str(tmp_path))}/rows\.jsonl: line {line} is corrupted \("
            ):
                campaign_rows(tmp_path)
    (tmp_path / "rows.jsonl").write_text(f'{good}{{"index": 0, "columns": {{"index": 0, {columns}}}}}\n')
    assert list(campaign_rows(tmp_path)[1]) == [0]


def test_the_table_of_limits_is_that_of_the_code() -> None:
    """docs/limits.md has every limit with its number, its unit and its reason, and no other."""
    text = (Path(__file__).parents[2] / "docs" / "limits.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| ([\d,]+) ([^|]+) \| ([^|]+) \|$", text, re.MULTILINE)
    assert rows == [(one.name, f"{one.most:,}", one.unit, one.why) for one in LIMITS]
    assert len({one.name for one in LIMITS}) == len(LIMITS)
