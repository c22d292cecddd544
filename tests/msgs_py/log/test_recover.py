"""What is left of a truncated or corrupted bag is found, and what is lost is said."""

from __future__ import annotations

import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader

from space_robot_msgs_py.attitude import SOURCES
from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.errors import InputFileError, LogError, SpaceRobotError
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.mcap.records import MAGIC, PREFIX, scan
from space_robot_msgs_py.log.mcap.salvage import Damage, salvage
from space_robot_msgs_py.log.numbering import ANY_TOPIC
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.recover import recover
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values

COUNT = 150
BY_TICK = (*LOGGED, *SOURCES)


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The same log as it is while it is written, and closed."""
    return forms(tmp_path_factory.mktemp("logs") / "run", COUNT)


def forms(place: Path, count: int) -> dict[str, bytes]:
    sink = LogSink(place, values.HEADER)
    for tick in values.run_ticks(count):
        sink.record(tick)
    plain = sink.writer.path.read_bytes()
    sink.close("completed")
    return {"plain": plain, "closed": sink.writer.path.read_bytes()}


def put(place: Path, data: bytes) -> Path:
    place.mkdir(exist_ok=True)
    path = place / "bad_0.mcap"
    path.write_bytes(data)
    return path


def records(data: bytes) -> list[bytes]:
    """The records of a file, each with its prefix."""
    stream = io.BytesIO(data)
    stream.read(len(MAGIC))
    return [PREFIX.pack(opcode, len(content)) + content for opcode, content in scan(stream, len(data))]


def bits(reader: LogReader) -> list[object]:
    return [values.bits(tick) for tick in reader.ticks()]


WHOLE = [values.bits(tick) for tick in values.run_ticks(COUNT)]


@pytest.mark.parametrize("share", [0.4, 0.7, 0.86])
@pytest.mark.parametrize("form", ["plain", "closed"])
def test_a_truncated_log_gives_all_ticks_before_the_truncation(
    logs: dict[str, bytes], tmp_path: Path, form: str, share: float
) -> None:
    """The recovered bag is indexed, opens in rosbags and holds the beginning of the run, bit for bit."""
    data = logs[form]
    done = recover(put(tmp_path / "bad", data[: int(share * len(data))]), tmp_path / "good")
    reader = LogReader(done.path)
    ticks = bits(reader)
    assert 0.2 * share * COUNT < len(ticks) < COUNT
    assert ticks == WHOLE[: len(ticks)]
    assert done.complaint == ""
    assert done.end_reason is reader.end_reason is None
    assert [lost.what for lost in done.damage] == ["cut within a record"]
    assert done.last_stamp in ((len(ticks) - 1) * values.PERIOD, len(ticks) * values.PERIOD)
    with AnyReader([done.path.parent]) as bag:
        assert bag.message_count == sum(done.kept.values()) == sum(1 for _ in bag.messages())


@pytest.mark.parametrize("form", ["plain", "closed"])
def test_a_whole_log_loses_nothing(logs: dict[str, bytes], tmp_path: Path, form: str) -> None:
    """Recovering what is whole gives every message; of a closed log the same file."""
    done = recover(put(tmp_path / "bad", logs[form]), tmp_path / "good")
    assert done.whole
    assert bits(LogReader(done.path)) == WHOLE
    assert done.end_reason == ("completed" if form == "closed" else None)
    again = recover(done.path, tmp_path / "again")
    assert again.path.read_bytes() == done.path.read_bytes()
    if form == "closed":
        assert done.path.read_bytes() == logs[form]


def test_damage_within_costs_one_chunk_and_is_counted(logs: dict[str, bytes], tmp_path: Path) -> None:
    """A flipped byte in one chunk of several loses that chunk; the messages in it are counted by topic."""
    data = bytearray(logs["closed"])
    chunks = [item.offset for item in _chunks(bytes(data))]
    assert len(chunks) >= 3
    data[chunks[1] + 1000] ^= 1
    done = recover(put(tmp_path / "bad", bytes(data)), tmp_path / "good")
    ticks = bits(LogReader(done.path))
    assert set(map(str, ticks)) < set(map(str, WHOLE))
    assert done.lost == {f"/{topic.name}": COUNT - len(ticks) for topic in BY_TICK}
    assert [lost.offset for lost in done.damage] == [chunks[1]]
    assert done.end_reason == "completed"


def _chunks(data: bytes) -> list[Damage]:
    """Where the chunks of a file are."""
    found, position = [], len(MAGIC)
    for record in records(data):
        if record[0] == Opcode.CHUNK:
            found.append(Damage(position, len(record), "chunk"))
        position += len(record)
    return found


def test_records_taken_out_are_counted_by_their_numbers(logs: dict[str, bytes], tmp_path: Path) -> None:
    """A killed log has no count of its messages; gaps in their numbers show losses."""
    kept = records(logs["plain"])
    message_indices = [index for index, record in enumerate(kept) if record[0] == Opcode.MESSAGE]
    del kept[message_indices[100] : message_indices[100] + 5]
    done = recover(put(tmp_path / "bad", MAGIC + b"".join(kept)), tmp_path / "good")
    assert sum(done.lost.values()) == 5
    assert bits(LogReader(done.path))


@pytest.mark.parametrize("form", ["plain", "closed"])
def test_a_damaged_beginning_is_no_end(logs: dict[str, bytes], tmp_path: Path, form: str) -> None:
    """Without magic and first record every tick is still found."""
    done = recover(put(tmp_path / "bad", b"\xff" * 20 + logs[form][20:]), tmp_path / "good")
    assert bits(LogReader(done.path)) == WHOLE
    assert done.damage[0].offset == 0


def test_recover_of_a_log_without_its_header_says_so(logs: dict[str, bytes], tmp_path: Path) -> None:
    """With its header damaged a log becomes a bag: all messages, and a complaint that says so."""
    data = logs["closed"].replace(b"seed: 7\nname: test", b"seed: 8\nname: test")
    done = recover(put(tmp_path / "bad", data), tmp_path / "good")
    assert "header" in done.complaint
    assert sum(done.kept.values()) == 1 + COUNT * len(BY_TICK)
    with AnyReader([done.path.parent]) as bag:
        assert bag.message_count == sum(done.kept.values())


@pytest.mark.parametrize("data", [b"", MAGIC, b"not mcap at all", bytes(5000), MAGIC + bytes(5000)])
def test_recover_of_a_log_without_messages_writes_nothing(tmp_path: Path, data: bytes) -> None:
    """Without a single message there is one line that says so, and no directory is left behind."""
    with pytest.raises((InputFileError, LogError), match="bad") as caught:
        recover(put(tmp_path / "bad", data), tmp_path / "good")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "good").exists()


def test_a_failure_leaves_what_was_in_the_target(logs: dict[str, bytes], tmp_path: Path) -> None:
    """An earlier run in the target is replaced by a recovered bag, and not by a failure."""
    good = recover(put(tmp_path / "bad", logs["closed"]), tmp_path / "good").path
    with pytest.raises(LogError, match="no message"):
        recover(put(tmp_path / "worse", logs["closed"][:5000]), tmp_path / "good")
    assert good.read_bytes() == logs["closed"]
    recover(put(tmp_path / "bad", logs["plain"][:-5000]), tmp_path / "good")
    assert 0 < len(bits(LogReader(good))) < COUNT
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad", "good", "worse"]


def test_a_damaged_number_is_no_loss(logs: dict[str, bytes], tmp_path: Path) -> None:
    """One wrong sequence number in a log that was killed is not taken for a million lost messages."""
    data = bytearray(logs["plain"])
    position = len(MAGIC)
    for record in records(logs["plain"])[:-30]:
        position += len(record)
    assert data[position] == Opcode.MESSAGE
    data[position + PREFIX.size + 4] ^= 0xFF
    assert recover(put(tmp_path / "bad", bytes(data)), tmp_path / "good").lost == {}


def test_the_damaged_bag_is_never_written_to(logs: dict[str, bytes], tmp_path: Path) -> None:
    """The place of the old bag is refused as that of the new one, and so is a directory of something else."""
    path = put(tmp_path / "bad", logs["plain"][:-5000])
    with pytest.raises(LogError, match="another directory"):
        recover(path, tmp_path / "bad")
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("years")
    with pytest.raises(LogError, match="not empty"):
        recover(path, tmp_path / "precious")
    assert path.read_bytes() == logs["plain"][:-5000]


def test_lengths_are_checked_before_memory_is_allocated(logs: dict[str, bytes], tmp_path: Path) -> None:
    """With any byte of a chunk's head set to 255, looking and recovering take no more than a few times the file."""
    data = logs["closed"]
    start = _chunks(data)[0].offset
    for shift in range(80):
        bad = bytearray(data)
        bad[start + shift] = 0xFF
        path = put(tmp_path / "bad", bytes(bad))
        tracemalloc.start()
        try:
            kept = sum(not isinstance(item, Damage) for item in salvage(path))
            peak = tracemalloc.get_traced_memory()[1]
        except SpaceRobotError:
            continue
        finally:
            tracemalloc.stop()
        assert kept
        assert peak < 10 * len(data), shift


def test_no_truncation_and_no_flipped_byte_makes_a_traceback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut at 200 and damaged at 200 random places, a log is recovered to something readable or refused in one line."""
    # What takes nearly all the time, and depends on the damage only by its counts.
    monkeypatch.setattr("space_robot_msgs_py.log.recover.write_metadata_yaml", _touch)
    logs, rng = forms(tmp_path / "run", 40), np.random.default_rng(6)
    recovered = 0
    for index in range(400):
        data = bytearray(logs["plain" if index % 4 < 2 else "closed"])
        place = int(rng.integers(len(data)))
        if index % 2:
            del data[place:]
        else:
            data[place] ^= int(rng.integers(1, 256))
        path = put(tmp_path / "bad", bytes(data))
        said = ""
        try:
            done = recover(path, tmp_path / "good")
            recovered += 1
            assert sum(1 for _ in Bag(done.path).messages()) == sum(done.kept.values()) > 0
        except SpaceRobotError as error:
            said = str(error)
        assert "\n" not in said
    assert recovered > 200


def other_tools(path: Path, counters: str, drop: range = range(0)) -> Path:
    """A bag of two topics, one of them JSON without a schema, whose messages are counted by topic or by file."""
    path.parent.mkdir()
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=200)
        writer.start("ros2")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channels = (writer.register_channel("/a", "cdr", schema), writer.register_channel("/b", "json", 0))
        for index in set(range(40)).difference(drop):
            number = index if counters == "file" else index // 2
            writer.add_message(channels[index % 2], index, b'{"text": 1}', index, 7 + number)
        writer.finish()
    return path


def test_channels_without_a_schema_are_kept(tmp_path: Path) -> None:
    """JSON needs no schema: its topic, encoding and messages are in the recovered bag, and nothing is lost."""
    done = recover(other_tools(tmp_path / "bag" / "bag_0.mcap", "topic"), tmp_path / "good")
    assert done.whole
    assert done.kept == {"/a": 20, "/b": 20}
    with done.path.open("rb") as stream:
        found = [(c.topic, c.message_encoding, s is None) for s, c, _ in make_reader(stream).iter_messages()]
    assert set(found) == {("/a", "cdr", False), ("/b", "json", True)}


@pytest.mark.parametrize(
    ("counters", "drop", "lost"),
    [
        ("topic", range(0), {}),
        ("file", range(0), {}),
        ("topic", range(10, 16), {"/a": 3, "/b": 3}),
        ("file", range(10, 15), {ANY_TOPIC: 5}),
    ],
)
def test_numbers_may_count_by_topic_or_by_file(
    tmp_path: Path, counters: str, drop: range, lost: dict[str, int]
) -> None:
    """Where a bag has no count at its end, its numbers say what is missing; a counter over the file is no loss."""
    path = other_tools(tmp_path / "bag" / "bag_0.mcap", counters, drop)
    data = path.read_bytes()
    end = next(place for place in range(len(data)) if data[place] == Opcode.DATA_END and data[place + 1] == 4)
    path.write_bytes(data[:end])
    assert recover(path, tmp_path / "good").lost == lost


def _touch(path: Path, *_: object, **__: object) -> None:
    path.with_name("metadata.yaml").touch()
