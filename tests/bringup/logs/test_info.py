"""A large bag is looked at by its index: the same numbers, without a look at its messages."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from mcap.opcode import Opcode
from mcap.writer import Writer

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.logs import info
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import BagInfo, bag_info
from space_robot_bringup.modes.run import judge_log, run_experiment
from space_robot_bringup.replay.publish import open_broadcast
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.mcap.records import MAGIC, PREFIX
from space_robot_msgs_py.log.mcap.summary import Summary
from tests.support.tool import Tool, refused


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("bags") / "fig08"
    run_experiment(load_experiment("liu2023/fig08"), directory, mode="headless")
    return directory


@pytest.fixture
def by_index(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every bag is a large one."""
    monkeypatch.setattr(info, "LARGE", 0)


def topics(found: BagInfo) -> dict[str, tuple[object, ...]]:
    return {topic.name: (topic.type, topic.count, topic.first, topic.last, topic.rate) for topic in found.topics}


def foreign(path: Path) -> None:
    """A bag of another tool: chunks of one second, a topic that begins late, messages out of order."""
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=200)
        writer.start("ros2", "another tool")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        steady, late = (writer.register_channel(f"/{name}", "cdr", schema) for name in ("steady", "late"))
        for k in range(50):
            time = k * 1_000_000 + (5_000_000 if k % 10 == 3 else 0)
            writer.add_message(steady, time, b"\0\1\0\0\1\0\0\0\0", time)
            if k > 40:
                writer.add_message(late, time + 7, b"\0\1\0\0\1\0\0\0\0", time)
        writer.finish()


@pytest.mark.usefixtures("by_index")
def test_an_index_tells_what_the_messages_tell(bag: Path, tmp_path: Path) -> None:
    """Topics, types, counts, rates, first and last times, provenance and end are those of a look at every message."""
    foreign(tmp_path / "foreign.mcap")
    for path in (bag, tmp_path / "foreign.mcap"):
        index, full = bag_info(path), bag_info(path, full=True)
        assert (index.by_index, full.by_index) == (True, False)
        assert topics(index) == topics(full)
        for name in ("size", "messages", "provenance", "versions", "end_reason"):
            assert getattr(index, name) == getattr(full, name)
        assert {topic.gaps for topic in index.topics} == {None}
        assert index.verdict.passed is None
        assert "--full" in index.verdict.why_not
    assert bag_info(bag, full=True).verdict.passed


def test_a_small_bag_is_looked_at_as_a_whole(bag: Path) -> None:
    """Below the limit every message is looked at without `--full`."""
    assert not bag_info(bag).by_index


@pytest.mark.usefixtures("by_index")
def test_an_index_that_is_damaged_is_not_used(bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without an index, with a damaged one, or one that leads to something else, every message is looked at."""
    data = (bag / "fig08_0.mcap").read_bytes()
    whole = topics(bag_info(bag, full=True))
    path = tmp_path / "bad_0.mcap"
    for at in range(len(data) - 3000, len(data) - 9, 500):
        path.write_bytes(data[:at] + bytes([data[at] ^ 0x40]) + data[at + 1 :])
        found = bag_info(path)
        assert not found.by_index
        assert topics(found) == whole
    monkeypatch.setattr(Summary, "_record", lambda self, stream, place, opcode: b"")
    assert not bag_info(bag).by_index


def without_chunks(data: bytes, which: slice) -> bytes:
    """The log with the opcodes of some of its chunks damaged."""
    spoiled, at, chunks = bytearray(data), len(MAGIC), []
    while data[at] != Opcode.FOOTER:
        chunks += [at] if data[at] == Opcode.CHUNK else []
        at += PREFIX.size + PREFIX.unpack_from(data, at)[1]
    assert len(chunks) > 2
    for chunk in chunks[which]:
        spoiled[chunk] = Opcode.SUMMARY_OFFSET
    return bytes(spoiled)


@pytest.mark.parametrize("which", [slice(0, 1), slice(-1, None), slice(None)], ids=["first", "last", "every"])
def test_whatever_reads_a_log_says_that_messages_are_missing(
    bag: Path, tmp_path: Path, space_robot: Tool, which: slice
) -> None:
    """One damaged byte hides a chunk: info counts what is missing, verdict and page say it, replay refuses the log."""
    run = tmp_path / "run"
    run.mkdir()
    (run / "run_0.mcap").write_bytes(without_chunks((bag / "fig08_0.mcap").read_bytes(), which))
    found = bag_info(run)
    assert found.missing["/base/odom"] > 0
    assert not found.verdict.passed
    assert "missing" in found.verdict.why_not
    composition = compose(load_experiment("liu2023/fig08"))
    result = judge_log(run, composition, "completed", 0.0)
    assert not result.passed
    assert "missing" in result.end_reason
    if which == slice(-1, None):
        page = read_judged(run)
        assert "missing" in page.troubles[0]
        assert not all(check.passed for check in page.checks)
    else:
        with pytest.raises(LogError, match="missing"):
            read_judged(run)
    with pytest.raises(LogError, match="missing"):
        open_broadcast(run)
    refused(space_robot("replay", str(run)), "missing")
    done = space_robot("info", str(run))
    assert (done.returncode, "missing: " in done.stdout) == (0, True)
    listed = json.loads(space_robot("info", str(run), "--full", "--json").stdout)
    assert listed["missing"] == dict(found.missing)
