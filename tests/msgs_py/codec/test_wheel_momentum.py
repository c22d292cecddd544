"""The momentum of the wheels in messages, ticks and logs: with the reading, without it, and with a part of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec, WheelMomentumCodec
from space_robot_msgs_py.errors import LayoutError, LogError, NonFiniteError
from space_robot_msgs_py.interfaces import RobotState, Tick
from space_robot_msgs_py.log.arrays import arrays_of
from space_robot_msgs_py.log.preamble import CHANNELS
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink, LogWriter
from space_robot_msgs_py.topics import ATTITUDE, REFERENCE_ATTITUDE, TABLE, WHEEL_MOMENTUM, topics_of
from tests.support import values


def unmeasured(tick: Tick) -> Tick:
    """The tick of a run whose wheels are not measured."""
    return replace(tick, sample=replace(tick.sample, state=replace(tick.sample.state, wheel_momentum=None)))


def parts_of(tick: Tick) -> dict[str, bytes]:
    """Its messages by topic name."""
    encoded = zip(LOGGED, TickCodec(values.NAMES).encode(tick), strict=True)
    return {topic.name: raw for topic, raw in encoded if raw is not None}


def test_a_tick_has_the_message_where_its_state_has_the_reading() -> None:
    """With and without: the tick comes back bit for bit, and only its own topic differs."""
    tick = values.run_ticks(1)[0]
    with_it, without = parts_of(tick), parts_of(unmeasured(tick))
    assert with_it.keys() - without.keys() == {WHEEL_MOMENTUM.name}
    assert all(with_it[name] == raw for name, raw in without.items())
    for one, parts in ((tick, with_it), (unmeasured(tick), without)):
        assert values.bits(TickCodec(values.NAMES).decode(parts)) == values.bits(one)
    unanswered = TickCodec(values.NAMES).encode_unanswered(tick.sample, tick.reference)
    assert unanswered[LOGGED.index(WHEEL_MOMENTUM)] == with_it[WHEEL_MOMENTUM.name]


def test_a_reading_that_is_no_number_or_of_another_stamp_is_refused() -> None:
    """NaN and infinity pass neither message nor state, and a reading belongs to the state of its stamp."""
    first, second = values.run_ticks(2)
    codec, parts = WheelMomentumCodec(), parts_of(first)
    (bad,) = codec.encode((0, np.array([0.0, np.inf, 0.0])))
    for decode in (codec.read, lambda raw: codec.added(first.sample.state, raw)):
        with pytest.raises(NonFiniteError, match="wheel_momentum"):
            decode(bad)
    with pytest.raises(NonFiniteError, match=r"state\.wheel_momentum"):
        RobotState(0, np.zeros(7), np.zeros(6), np.zeros(0), np.zeros(3), np.full(3, np.nan))
    late = parts_of(second)[WHEEL_MOMENTUM.name]
    with pytest.raises(LayoutError, match=r"base/wheel_momentum: .*stamps"):
        TickCodec(values.NAMES).decode(parts | {WHEEL_MOMENTUM.name: late})


def test_a_log_whose_header_names_no_reading_has_no_channel_and_takes_none(tmp_path: Path) -> None:
    """The topic is optional: a log without it is what it was, and one with it names it."""
    names = tuple(name for name in values.HEADER.topics if name != WHEEL_MOMENTUM.name)
    sink = LogSink(tmp_path / "run", replace(values.HEADER, topics=names))
    sink.record(unmeasured(values.run_ticks(1)[0]))
    with pytest.raises(LogError, match="no such topic"):
        sink.record(values.run_ticks(2)[1])
    sink.close("completed")
    assert b"wheel_momentum" not in (tmp_path / "run" / "run_0.mcap").read_bytes()
    reader = LogReader(tmp_path / "run")
    assert reader.arrays().wheel_momentum is None
    assert [values.bits(tick) for tick in reader.ticks()] == [values.bits(unmeasured(values.run_ticks(1)[0]))]


def test_the_channel_came_last_so_that_the_others_keep_their_numbers() -> None:
    """What was in logs before it comes first; only the angles, which came with it, stand behind."""
    behind = {name for name, number in CHANNELS.items() if number > CHANNELS[WHEEL_MOMENTUM.name]}
    assert behind == {ATTITUDE.name, REFERENCE_ATTITUDE.name}
    assert WHEEL_MOMENTUM not in topics_of("state")
    assert WHEEL_MOMENTUM in TABLE


def test_a_tick_without_its_reading_is_not_complete(tmp_path: Path) -> None:
    """Where the header names the topic it is part of the state, as the last tick of a truncated log shows."""
    writer, codec = LogWriter(tmp_path / "run", values.HEADER), TickCodec(values.NAMES)
    for index, tick in enumerate(values.run_ticks(3)):
        row = list(codec.encode(tick))
        if index == 2:
            row[LOGGED.index(WHEEL_MOMENTUM)] = None
        writer.write_row(tick.stamp, row)
    writer.close("completed")
    reader = LogReader(tmp_path / "run")
    assert reader.arrays().wheel_momentum is not None
    assert reader.arrays().stamp.tolist() == [0, values.PERIOD]


def test_arrays_of_some_readings_are_refused() -> None:
    """All ticks have the reading, or none has."""
    first, second = values.run_ticks(2)
    assert arrays_of([unmeasured(first), unmeasured(second)]).wheel_momentum is None
    with pytest.raises(LayoutError, match=r"base/wheel_momentum: at some ticks only; got '?1 of 2"):
        arrays_of([first, unmeasured(second)])
