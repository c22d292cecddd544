import os
import resource
import signal
import subprocess
import sys

import pytest

from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink, LogWriter, MemorySink
from space_robot_msgs_py.topics import CLOCK, CONTROLLER_TELEMETRY
from tests.support import values
from tests.support.paths import ROOT


def write(directory, ticks, *, reason="completed", **options):
    """A closed log; returns its .mcap."""
    sink = LogSink(directory, values.HEADER, **options)
    for tick in ticks:
        sink.record(tick)
    sink.close(reason)
    return sink.writer.path


def test_equal_runs_are_equal_files(tmp_path):
    """Equal ticks give equal bytes, whatever the directory is called and whatever is remarked about the run."""
    first = write(tmp_path / "first", values.run_ticks(40), custom={"mode": "graph"})
    second = write(tmp_path / "deep" / "second", values.run_ticks(40), custom={"mode": "headless"})
    assert first.name == "first_0.mcap"
    assert first.read_bytes() == second.read_bytes()


def test_runs_that_differ_in_one_bit_differ_as_files(tmp_path):
    """Runs that differ in one number differ as files."""
    first = write(tmp_path / "first", values.run_ticks(3, seed=0))
    second = write(tmp_path / "second", values.run_ticks(3, seed=1))
    assert first.read_bytes() != second.read_bytes()


def test_ticks_and_values_are_written_the_same(tmp_path):
    """A recorder that writes messages and a sink that writes values make the same file, in any order of topics."""
    ticks, codec = values.run_ticks(5), TickCodec(values.NAMES)
    writer = LogWriter(tmp_path / "messages", values.HEADER)
    writer.write_description(values.HEADER.urdf)
    for tick in ticks:
        parts = dict(zip(LOGGED, codec.encode(tick), strict=True))
        writer.write_tick(tick.stamp, dict(reversed(parts.items())))
    writer.close("completed")
    assert writer.path.read_bytes() == write(tmp_path / "values", ticks).read_bytes()


def test_everything_is_readable_while_the_run_goes_on(tmp_path):
    """After every tick the file holds it, and says that the run has not ended."""
    sink, ticks = LogSink(tmp_path / "run", values.HEADER), values.run_ticks(4)
    assert list(LogReader(tmp_path / "run").ticks()) == []
    for count, tick in enumerate(ticks, start=1):
        sink.record(tick)
        reader = LogReader(tmp_path / "run")
        assert values.bits(list(reader.ticks())[-1]) == values.bits(tick)
        assert len(list(reader.ticks())) == count
        assert reader.end_reason is None
    sink.close("completed")


WRITER = """
import sys
from pathlib import Path
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values
sink = LogSink(Path(sys.argv[1]), values.HEADER)
for count, tick in enumerate(values.run_ticks(500), start=1):
    sink.record(tick)
    print(count, flush=True)
sink.close("completed")
"""


@pytest.mark.parametrize("kill_after", [1, 2, 57, 300])
def test_kill_loses_no_tick_that_was_written(tmp_path, kill_after):
    """After SIGKILL every tick whose writing had returned is in the file, bit for bit, and more is never invented."""
    command = [sys.executable, "-c", WRITER, str(tmp_path / "run")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT) as child:
        written = 0
        while written < kill_after:
            written = int(child.stdout.readline())
        os.kill(child.pid, signal.SIGKILL)
        written = max([written, *(int(line) for line in child.stdout.read().split())])
    assert child.returncode == -signal.SIGKILL
    reader = LogReader(tmp_path / "run")
    ticks = list(reader.ticks())
    assert written <= len(ticks) <= written + 1
    expected = values.run_ticks(500)[: len(ticks)]
    assert [values.bits(tick) for tick in ticks] == [values.bits(tick) for tick in expected]
    assert reader.end_reason is None
    assert reader.header == values.HEADER


def test_kill_between_end_and_index_leaves_the_plain_file(tmp_path, monkeypatch):
    """A run that dies while its file is indexed is whole, with its reason, and can be replaced by the next run."""

    def die(incoming, outgoing, *_):
        outgoing.write(b"half an index")
        raise KeyboardInterrupt

    monkeypatch.setattr("space_robot_msgs_py.log.closing.write_indexed", die)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "run", values.run_ticks(3))
    monkeypatch.undo()
    reader = LogReader(tmp_path / "run")
    assert (len(list(reader.ticks())), reader.end_reason) == (3, "completed")
    write(tmp_path / "run", values.run_ticks(2))
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == ["metadata.yaml", "run_0.mcap"]


def test_closing_twice_keeps_the_first_reason(tmp_path):
    """The second close does nothing, and nothing can be written any more."""
    sink = LogSink(tmp_path / "run", values.HEADER)
    sink.close("interrupted")
    sink.close("completed")
    assert LogReader(tmp_path / "run").end_reason == "interrupted"
    with pytest.raises(LogError, match="closed"):
        sink.record(values.run_ticks(1)[0])


def test_time_must_go_on(tmp_path):
    """A tick that is not later than the one before is refused, and the log stays as it was."""
    sink, ticks = LogSink(tmp_path / "run", values.HEADER), values.run_ticks(2)
    sink.record(ticks[1])
    for tick in (ticks[1], ticks[0]):
        with pytest.raises(LogError, match="time does not go on"):
            sink.record(tick)
    sink.close("completed")
    assert len(list(LogReader(tmp_path / "run").ticks())) == 1


def test_only_topics_of_a_tick_are_written(tmp_path):
    """A topic that is not recorded is refused by name; the description comes once and first."""
    writer = LogWriter(tmp_path / "run", values.HEADER)
    with pytest.raises(LogError, match="/clock"):
        writer.write_tick(0, {CLOCK: b""})
    writer.write_description("<robot/>")
    with pytest.raises(LogError, match="first message"):
        writer.write_description("<robot/>")
    writer.close("completed")


def test_a_run_without_telemetry_is_complete(tmp_path):
    """Ticks of a controller that publishes no telemetry are read with empty telemetry."""
    writer, codec = LogWriter(tmp_path / "run", values.HEADER), TickCodec(values.NAMES)
    for tick in values.run_ticks(3):
        parts = dict(zip(LOGGED, codec.encode(tick), strict=True))
        del parts[CONTROLLER_TELEMETRY]
        writer.write_tick(tick.stamp, parts)
    writer.close("completed")
    reader = LogReader(tmp_path / "run")
    assert [tick.output.telemetry.labels for tick in reader.ticks()] == [()] * 3
    assert (reader.arrays().controller, list(reader.arrays().plant)) == ({}, ["energy"])


def test_a_previous_run_is_replaced(tmp_path):
    """A directory that holds a previous run, closed or killed, takes the next one; other files of the user stay."""
    write(tmp_path / "run", values.run_ticks(9), custom={"mode": "old"})
    (tmp_path / "run" / "notes.txt").write_text("mine")
    sink = LogSink(tmp_path / "run", values.HEADER)
    assert not (tmp_path / "run" / "metadata.yaml").exists()
    sink.close("interrupted")
    write(tmp_path / "run", values.run_ticks(1))
    assert len(list(LogReader(tmp_path / "run").ticks())) == 1
    assert "old" not in (tmp_path / "run" / "metadata.yaml").read_text()
    assert (tmp_path / "run" / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("name", ["thesis.tex", "run_0.mcap", "other_0.mcap"])
def test_a_bag_of_another_tool_is_never_replaced(tmp_path, name):
    """A directory with other content, another project's bag among it, is refused by name and left as it is."""
    place = tmp_path / "run"
    place.mkdir()
    (place / name).write_bytes(b"\x89MCAP0\r\n and then something else")
    with pytest.raises(LogError, match=f"{place}.*not a run directory"):
        LogWriter(place, values.HEADER)
    assert (place / name).read_bytes().endswith(b"something else")


def test_a_bag_of_another_tool_in_the_run_directory_is_refused(tmp_path):
    """A run of this project does not license the removal of a foreign bag in the same directory."""
    write(tmp_path / "run", values.run_ticks(1))
    (tmp_path / "run" / "other_0.mcap").write_bytes(b"precious")
    with pytest.raises(LogError, match="not a run directory"):
        LogWriter(tmp_path / "run", values.HEADER)


def test_a_file_in_the_way_is_named(tmp_path):
    """A file where the directory, or one above it, should be is a LogError in one line."""
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / "file" / "run"):
        with pytest.raises(LogError, match=str(place)) as caught:
            LogWriter(place, values.HEADER)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("limit", [100, 20_000, 64_000])
def test_a_full_disk_is_one_clear_error(tmp_path, limit):
    """When the disk takes no more the run gets one LogError, and what was written before stays readable."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        with pytest.raises(LogError, match=r"run_0\.mcap.*cannot be written") as caught:
            write(tmp_path / "run", values.run_ticks(100))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "\n" not in str(caught.value)
    if limit > 20_000:
        ticks = list(LogReader(tmp_path / "run").ticks())
        expected = values.run_ticks(100)[: len(ticks)]
        assert len(ticks) > 5
        assert [values.bits(tick) for tick in ticks] == [values.bits(tick) for tick in expected]
        assert "recorder: " in str(LogReader(tmp_path / "run").end_reason)


def test_memory_sink_keeps_everything():
    """The sink in memory has the same ticks, and the first reason."""
    sink, ticks = MemorySink(), values.run_ticks(3)
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")
    sink.close("again")
    assert (sink.ticks, sink.end_reason) == (ticks, "completed")
