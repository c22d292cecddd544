"""Ticks that are written at once have the bytes of ticks that are written message by message."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from space_robot_msgs_py.codec.codecs import TickCodec
from space_robot_msgs_py.errors import LayoutError, SpaceRobotError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.writer import LogSink, LogWriter
from tests.support.log_ticks import NAMES, URDF, tick_of


def test_a_run_of_any_ticks_has_the_bytes_of_its_messages_one_by_one(tmp_path: Path) -> None:
    """Also where labels change, something happens, and a message is missing, after which the topics are out of step."""
    event = ControllerEvent(400_000_000, "reset", {"law": "pd"})
    ticks = [tick_of(index) for index in range(4)]
    ticks += [tick_of(4, events=(event,)), tick_of(5, labels=("z",)), *map(tick_of, range(6, 9))]
    header = LogHeader("", URDF, 0, NAMES)
    sink, codec = LogSink(tmp_path / "a" / "run", header), TickCodec(NAMES)
    writer = LogWriter(tmp_path / "b" / "run", header)
    writer.write_description(URDF)
    for tick in ticks:
        sink.record(tick)
        writer.write_row(tick.stamp, codec.encode(tick))
    last = tick_of(9)
    sink.record_unanswered(last.sample, last.reference)
    writer.write_row(last.stamp, codec.encode_unanswered(last.sample, last.reference))
    sink.record(tick_of(10))
    writer.write_row(10 * 100_000_000, codec.encode(tick_of(10)))
    for one in (sink.writer, writer):
        one.close("completed")
    assert sink.writer.path.read_bytes() == writer.path.read_bytes()


def test_a_tick_that_fits_no_block_is_refused_as_before(tmp_path: Path) -> None:
    """One of another robot, and one whose parts have other stamps."""
    sink = LogSink(tmp_path / "run", LogHeader("", URDF, 0, NAMES))
    sink.record(tick_of(0))
    with pytest.raises(SpaceRobotError):
        sink.record(tick_of(1, joints=3))
    with pytest.raises(LayoutError, match="values of different stamps"):
        sink.record(replace(tick_of(1), reference=tick_of(2).reference))
    sink.close("completed")
