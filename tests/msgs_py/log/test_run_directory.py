"""One run at a time writes to a run directory, and what happens to the directory meanwhile is noticed at once."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.closing import close_log_of_dead_writer
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values
from tests.support.paths import ROOT

DYING = """
import os, sys
from pathlib import Path
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values
sink = LogSink(Path(sys.argv[1]), values.HEADER)
for tick in values.run_ticks(5):
    sink.record(tick)
with sink.writer.path.open("ab") as torn:
    torn.write(b"\\x05 half a record")
os.kill(os.getpid(), 9)
"""


def test_a_second_run_into_one_directory_is_refused(tmp_path: Path) -> None:
    """While a run writes, another is refused by name and changes nothing; afterwards it may."""
    ticks = values.run_ticks(6)
    first = LogSink(tmp_path / "run", values.HEADER)
    for tick in ticks[:3]:
        first.record(tick)
    with pytest.raises(LogError, match=rf"{tmp_path / 'run'}: another run is writing here"):
        LogSink(tmp_path / "run", values.HEADER)
    for tick in ticks[3:]:
        first.record(tick)
    first.close("completed")
    assert [values.bits(tick) for tick in LogReader(tmp_path / "run").ticks()] == [values.bits(tick) for tick in ticks]
    LogSink(tmp_path / "run", values.HEADER).close("interrupted")
    assert LogReader(tmp_path / "run").end_reason == "interrupted"


def test_a_lock_that_was_inherited_is_the_same_lock(tmp_path: Path) -> None:
    """A writer that gets the open directory of its parent writes under its lock, which outlives the writer."""
    with RunDirectory(tmp_path / "run") as place:
        handed = RunDirectory(tmp_path / "run", inherited=os.dup(place.descriptor))
        LogSink(handed, values.HEADER).close("completed")
        with pytest.raises(LogError, match="another run is writing here"):
            RunDirectory(tmp_path / "run")
    assert LogReader(tmp_path / "run").end_reason == "completed"
    RunDirectory(tmp_path / "run").close()


def test_a_directory_nothing_was_written_to_is_gone_again(tmp_path: Path) -> None:
    """A directory that was made for a run which never began is removed; one that was there stays."""
    RunDirectory(tmp_path / "made").close()
    (tmp_path / "there").mkdir()
    RunDirectory(tmp_path / "there").close()
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


def _replace(run: Path) -> None:
    bag = run / "run_0.mcap"
    shutil.copyfile(bag, run / "copy")
    (run / "copy").replace(bag)


ATTACKS: dict[str, Callable[[Path], object]] = {
    "directory deleted": shutil.rmtree,
    "file deleted": lambda run: (run / "run_0.mcap").unlink(),
    "directory moved": lambda run: run.rename(run.with_name("elsewhere")),
    "file replaced": _replace,
}


@pytest.mark.parametrize("attack", ATTACKS.values(), ids=ATTACKS)
@pytest.mark.parametrize("late", [False, True], ids=["during the run", "before the end"])
def test_a_log_that_is_gone_is_noticed_at_once(tmp_path: Path, attack: Callable[[Path], object], late: bool) -> None:
    """The next tick, or the end, says that the log is gone; nothing temporary stays."""
    sink, ticks = LogSink(tmp_path / "run", values.HEADER), values.run_ticks(3)
    sink.record(ticks[0])
    attack(tmp_path / "run")
    with pytest.raises(LogError, match=r"run_0\.mcap: the log cannot be written: it was deleted, moved or replaced"):
        sink.close("completed") if late else sink.record(ticks[1])
    assert not list(tmp_path.rglob("*.tmp"))
    sink.close("again")


@pytest.mark.parametrize("name", ["run_0.mcap.tmp", "metadata.yaml.tmp", "metadata.yaml"])
def test_a_log_that_cannot_be_finished_says_so_itself(tmp_path: Path, name: str) -> None:
    """Where index or description cannot be written, the plain log has every tick, and that as its reason."""
    sink, ticks = LogSink(tmp_path / "run", values.HEADER), values.run_ticks(3)
    for tick in ticks:
        sink.record(tick)
    (tmp_path / "run" / name).mkdir()
    with pytest.raises(LogError, match="the log cannot be written"):
        sink.close("completed")
    reader = LogReader(tmp_path / "run")
    assert len(list(reader.ticks())) == 3
    assert (reader.end_reason or "").startswith(f"recorder: {reader.path}: the log cannot be written")
    assert [path.name for path in tmp_path.rglob("*.tmp")] == ([name] if name.endswith(".tmp") else [])


def test_the_log_of_a_writer_that_died_gets_its_reason(tmp_path: Path) -> None:
    """The log of a killed process, torn in a record, is closed with the reason, indexed and described; only once."""
    run = tmp_path / "run"
    child = subprocess.run([sys.executable, "-c", DYING, str(run)], cwd=ROOT, check=False)
    assert child.returncode == -9
    assert LogReader(run).end_reason is None
    with RunDirectory(run) as place:
        assert close_log_of_dead_writer(place, "recorder: killed", {"mode": "processes"})
        assert not close_log_of_dead_writer(place, "again", {})
    reader = LogReader(run)
    assert reader.end_reason == "recorder: killed"
    assert [values.bits(t) for t in reader.ticks()] == [values.bits(t) for t in values.run_ticks(5)]
    assert custom_data(reader.path) == {"mode": "processes", "end_reason": "recorder: killed"}
    whole = LogSink(tmp_path / "whole", values.HEADER)
    for tick in values.run_ticks(5):
        whole.record(tick)
    whole.close("recorder: killed")
    assert reader.path.read_bytes() == whole.writer.path.read_bytes()


def test_there_is_no_log_to_close_where_none_was_begun(tmp_path: Path) -> None:
    """An empty directory and a file cut within its head are left as they are."""
    with RunDirectory(tmp_path / "run") as place:
        assert not close_log_of_dead_writer(place, "no", {})
        place.bag.write_bytes(b"\x89MCAP0\r\n half")
        assert not close_log_of_dead_writer(place, "no", {})
        assert place.bag.read_bytes().endswith(b" half")
