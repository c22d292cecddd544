"""The index that is made of what was noted while a log was written."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.log.closing import close_log_of_dead_writer
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.mcap.index import CHUNK_SIZE
from space_robot_msgs_py.log.mcap.positions import Positions, Shape
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_msgs_py.log.writer import LogSink
from tests.msgs_py.log.test_tick_block import NAMES, URDF, tick_of


def sink_of(directory: Path, count: int) -> LogSink:
    """A log of so many ticks that is not closed: some ticks have an event, and the labels change now and then."""
    sink = LogSink(directory, LogHeader("", URDF, 0, NAMES))
    for index in range(count):
        events = (ControllerEvent(100_000_000 * index, "reset", {"law": "pd"}),) if index % 7 == 3 else ()
        sink.record(tick_of(index, events=events, labels=("x", "y") if index % 50 < 45 else ("z" * 40,)))
    return sink


@pytest.mark.parametrize("count", [0, 1, 300])
def test_an_index_made_while_writing_is_that_of_a_look_at_each_record(tmp_path: Path, count: int) -> None:
    """A log that its writer closes has the bytes of one that another closes, who reads it back; over several chunks."""
    closed, left = sink_of(tmp_path / "a" / "run", count), sink_of(tmp_path / "b" / "run", count)
    closed.close("completed")
    left.writer._release()
    with RunDirectory(tmp_path / "b" / "run") as place:
        assert close_log_of_dead_writer(place, "completed", {})
    assert closed.writer.path.read_bytes() == left.writer.path.read_bytes()
    # Of random numbers nothing is packed away.
    assert count < 300 or closed.writer.path.stat().st_size > 2 * CHUNK_SIZE


def test_a_stretch_ends_between_stamps_only() -> None:
    """However long the messages of one stamp are, they stay together; the next stamp begins a new stretch."""
    positions, shape = Positions(), Shape([(1, 100), (2, 50)])
    places = [0]
    for stamp in (0, 0, 0, 5, 6):
        positions.add(places[-1], stamp, shape)
        places.append(places[-1] + shape.size)
    found = list(positions.stretches(shape.size))
    assert [(one.start, one.stop, one.first, one.last) for one in found] == [
        (0, places[3], 0, 0),
        (places[3], places[5], 5, 6),
    ]
    assert {channel: rows.tolist() for channel, rows in found[0].entries.items()} == {
        channel: [[0, block * shape.size + offset] for block in range(3)] for channel, offset in ((1, 0), (2, 131))
    }
