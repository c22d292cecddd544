"""Bags as they are found: any folder, stamps since 1970, messages that a reader loses, encodings that are not ROS's."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer

from space_robot_bringup.logs.foreign_bag import Source
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.replay.publish import Broadcast, open_broadcast
from space_robot_msgs_py.errors import LogError, SpecError
from space_robot_msgs_py.log.bag import Bag, BagMessage
from space_robot_msgs_py.log.reader import LogReader
from tests.support.foreign_bags import FIRST, SHORT, TYPES, recorded, since_1970, with_mcap, write
from tests.support.replays import record_run, replayed


@pytest.fixture(scope="module")
def run_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a noisy run."""
    return record_run(tmp_path_factory.mktemp("logs") / "run", "liu2023/noise", SHORT)


def content(broadcast: Broadcast) -> object:
    return [(stamp, dict(parts)) for stamp, parts in broadcast.ticks], broadcast.joint_names, broadcast.period


@pytest.mark.parametrize("form", ["rosbags", "sqlite", "message", "file", "split", "namespace"])
def test_every_bag_that_replays_can_be_published(run_log: Path, tmp_path: Path, form: str) -> None:
    """Whatever wrote it: the ticks, joints and period are those of the run."""
    bag = write(form, run_log, tmp_path / "bag")
    source = Source("robot1") if form == "namespace" else Source()
    assert content(open_broadcast(bag, source)) == content(open_broadcast(run_log))


def test_a_renamed_run_is_a_run(run_log: Path, tmp_path: Path) -> None:
    """A folder with its file without a number: read as a log, and replayed."""
    (tmp_path / "moved").mkdir()
    (tmp_path / "moved" / "moved.mcap").write_bytes(LogReader(run_log).path.read_bytes())
    assert replayed(tmp_path / "moved").equal
    assert content(open_broadcast(tmp_path / "moved")) == content(open_broadcast(run_log))


def test_stamps_since_1970_count_from_the_first_state(run_log: Path, tmp_path: Path) -> None:
    """With ``--start first`` such a bag replays and is published as the run itself; without, the error says so."""
    with_mcap(tmp_path / "bag.mcap", since_1970(run_log), CompressionType.ZSTD)
    done = replayed(tmp_path / "bag.mcap", experiment="liu2023/noise", overrides=[SHORT], source=FIRST)
    assert [outcome.first for outcome in done.outcomes] == [None, None]
    assert {outcome.ticks for outcome in done.outcomes} == {sum(1 for _ in LogReader(run_log).ticks())}
    assert any("--start first reads states" in line for line in done.recording.remarks)
    stamps = [stamp for stamp, _ in open_broadcast(tmp_path / "bag.mcap", FIRST).ticks]
    assert stamps == [stamp for stamp, _ in open_broadcast(run_log).ticks]
    with pytest.raises(LogError, match="--start first"):
        replayed(tmp_path / "bag.mcap", experiment="liu2023/noise", overrides=[SHORT])
    with pytest.raises(SpecError, match="--start: no such choice"):
        Source(start="last")


def test_a_bag_without_a_state_has_no_first_one(run_log: Path, tmp_path: Path) -> None:
    """References and commands alone: one line."""
    with_mcap(tmp_path / "bag.mcap", since_1970(run_log, ("base/odom",)), CompressionType.ZSTD)
    with pytest.raises(LogError, match="no state in it to count from"):
        replayed(tmp_path / "bag.mcap", experiment="liu2023/noise", source=FIRST)


def counts(bag: Path) -> dict[str, int]:
    return {topic.name: topic.count for topic in bag_info(bag).topics}


def test_a_description_that_differs_from_its_files_loses_no_message(run_log: Path, tmp_path: Path) -> None:
    """Other quality of service in ``metadata.yaml`` than in the SQLite file, or no description: all are read."""
    bag = write("sqlite", run_log, tmp_path / "bag")
    whole, description = counts(bag), bag / "metadata.yaml"
    assert sum(whole.values()) > 100
    text = description.read_text()
    assert "offered_qos_profiles: []" in text
    for offer in ("[{depth: 5}]", "''", "'- history: 1'"):
        description.write_text(text.replace("offered_qos_profiles: []", f"offered_qos_profiles: {offer}"))
        assert counts(bag) == whole
    description.unlink()
    assert counts(bag) == whole


def test_messages_that_a_description_counts_and_no_reader_finds_are_missing(run_log: Path, tmp_path: Path) -> None:
    """``info`` names them by topic, and a replay does not go on without them."""
    bag = write("sqlite", run_log, tmp_path / "bag")
    with sqlite3.connect(bag / "bag.db3") as database:
        database.execute("DELETE FROM messages WHERE id IN (SELECT id FROM messages ORDER BY id LIMIT 7)")
    found = bag_info(bag)
    assert sum(found.missing.values()) == 7
    with pytest.raises(LogError, match="are missing, which the bag counts"):
        replayed(bag, experiment="liu2023/noise", overrides=[SHORT])


def in_encoding(place: Path, log: Path, encoding: str, head: bytes) -> Path:
    """A bag whose messages say they are of another encoding."""
    with place.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        channels: dict[str, int] = {}
        for name, time, raw in recorded(log):
            if name not in channels:
                channels[name] = writer.register_channel(f"/{name}", encoding, 0)
            writer.add_message(channels[name], time, head + raw[len(head) :], time)
        writer.finish()
    return place


@pytest.mark.parametrize(
    ("encoding", "head", "words"),
    [
        ("json", b"{", "not CDR; got 'json'"),
        ("protobuf", b"", "not CDR; got 'protobuf'"),
        ("cdr", b"\x00\x07", "XCDR2 encoding, not plain CDR; got 'kind 0x0007'"),
        ("cdr", b"\x00\x0a", "parameter list XCDR2 encoding, not plain CDR; got 'kind 0x000a'"),
    ],
)
def test_the_reason_names_the_encoding(run_log: Path, tmp_path: Path, encoding: str, head: bytes, words: str) -> None:
    """Our topics in another encoding: the error says which, in place of that there are none."""
    bag = in_encoding(tmp_path / "bag.mcap", run_log, encoding, head)
    with pytest.raises(LogError) as caught:
        replayed(bag, experiment="liu2023/noise")
    assert words in str(caught.value).replace('\\"', '"').replace("\\'", "'")
    assert "no message of our topics can be read" in str(caught.value)
    types = {topic.type for topic in bag_info(bag).topics}
    assert types == {"" if encoding == "cdr" else f"({encoding})"}
    first = next(item for item in Bag(bag).messages() if isinstance(item, BagMessage))
    assert first.encoding == encoding
    assert first.topic.lstrip("/") in TYPES
