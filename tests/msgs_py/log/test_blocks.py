"""A log of any length is read in blocks, and thinned while it is read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec, encode_events
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import PlantSample, Telemetry, Tick
from space_robot_msgs_py.log.blocks import BlockStacker
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import Thinner
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.topics import CONTROLLER_EVENTS
from tests.support import values

COUNT = 60


def write(place: Path, ticks: list[Tick]) -> LogReader:
    """A log of these ticks."""
    sink = LogSink(place, values.HEADER)
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")
    return LogReader(place)


@pytest.mark.parametrize("size", [1, 7, 59, 60, 5000])
def test_blocks_are_the_log_cut_to_pieces(tmp_path: Path, size: int) -> None:
    """Put together, blocks of any size are the arrays of the whole log, bit for bit."""
    reader = write(tmp_path / "run", values.run_ticks(COUNT))
    whole, blocks = reader.arrays(), list(reader.blocks(size))
    assert max(block.stamp.size for block in blocks) == min(size, COUNT)
    for name in ("stamp", "time", "q", "v", "effort", "wheel_momentum", "q_d", "v_d", "a_d", "wrench"):
        assert np.concatenate([getattr(block, name) for block in blocks]).tobytes() == getattr(whole, name).tobytes()
    for side in ("controller", "plant"):
        for label, array in getattr(whole, side).items():
            assert np.concatenate([getattr(block, side)[label] for block in blocks]).tobytes() == array.tobytes()


def test_blocks_have_the_ticks_that_can_be_decoded_and_say_what_is_wrong_with_the_others() -> None:
    """A stamp of another tick in one message, or events of one, leave out that tick alone, as ``ticks`` does."""
    codec, ticks = TickCodec(values.NAMES), values.run_ticks(9)
    rows = [
        (tick.stamp, {t.name: raw for t, raw in zip(LOGGED, codec.encode(tick), strict=True) if raw is not None})
        for tick in ticks
    ]
    rows[3][1]["joint_states"] = rows[4][1]["joint_states"]
    rows[6][1][CONTROLLER_EVENTS.name] = encode_events([ControllerEvent(ticks[5].stamp, "reset", {})])
    fitting = [codec.decode(rows[k][1]) for k in (0, 1, 2, 4, 5, 7, 8)]
    events = [event.line for tick in fitting for event in tick.output.events]
    assert events
    for size in (1, 4, 100):
        blocks = list(BlockStacker(values.NAMES, "log").blocks(rows, size))
        stamps = [stamp for block in blocks if block.arrays is not None for stamp in block.arrays.stamp.tolist()]
        assert stamps == [tick.stamp for tick in fitting]
        unfit = [(stamp, str(error)) for block in blocks for stamp, error in block.unfit]
        assert [stamp for stamp, _ in unfit] == [ticks[3].stamp, ticks[6].stamp]
        assert all("different stamps" in text for _, text in unfit)
        assert [event.line for block in blocks for event in block.events] == events


@pytest.mark.parametrize("size", [1, 2, 100])
def test_telemetry_that_changes_its_blocks_is_one_error_wherever_a_block_ends(tmp_path: Path, size: int) -> None:
    """A log whose telemetry changes its layout is refused with the topic, between two blocks as within one."""
    ticks = values.run_ticks(4)
    other = Telemetry.of(ticks[2].stamp, {"energy": 1.0, "more": np.zeros(3)})
    ticks[2] = replace(ticks[2], sample=PlantSample(ticks[2].sample.state, other))
    with pytest.raises(LogError, match="differ"):
        list(write(tmp_path / "run", ticks).blocks(size))


def test_a_thinned_log_keeps_its_ends_and_every_peak(tmp_path: Path) -> None:
    """Whole ticks are kept, in order: the first, the last, and the extremes of every column."""
    reader = write(tmp_path / "run", values.run_ticks(800))
    whole, thinner = reader.arrays(), Thinner(most=60)
    for block in reader.blocks(25):
        thinner.add(block)
    kept = thinner.arrays()
    assert kept is not None
    assert thinner.thinned
    assert thinner.ticks == whole.stamp.size > kept.stamp.size
    assert (kept.stamp[0], kept.stamp[-1]) == (whole.stamp[0], whole.stamp[-1])
    assert (np.diff(kept.stamp) > 0).all()
    rows = np.searchsorted(whole.stamp, kept.stamp)
    wide, thin = (np.hstack([one.q, one.v, one.wheel_momentum, *one.plant.values()]) for one in (whole, kept))
    assert thin.tobytes() == wide[rows].tobytes()
    for side in ("controller", "plant"):
        assert list(getattr(kept, side)) == list(getattr(whole, side))
    np.testing.assert_array_equal(thin.max(axis=0), wide.max(axis=0))
    np.testing.assert_array_equal(thin.min(axis=0), wide.min(axis=0))


def test_a_log_is_thinned_to_a_bounded_number_of_ticks(tmp_path: Path) -> None:
    """However long a log is, about as many ticks are kept as were asked for, spread over all of its time."""
    (block,) = write(tmp_path / "run", values.run_ticks(200)).blocks(5000)
    thinner, shift = Thinner(most=1500), int(block.stamp[-1] + block.stamp[1])
    for turn in range(60):
        thinner.add(replace(block, stamp=block.stamp + turn * shift))
    kept = thinner.arrays()
    assert kept is not None
    assert thinner.ticks == 60 * 200
    assert 750 < kept.stamp.size < 2 * 1500
    spread = np.histogram(kept.stamp, bins=16, range=(0, 60 * shift))[0]
    assert spread.min() > 20


def test_a_short_log_is_kept_as_it_is(tmp_path: Path) -> None:
    """Below the bound nothing is dropped."""
    reader, thinner = write(tmp_path / "run", values.run_ticks(50)), Thinner(most=50)
    for block in reader.blocks(13):
        thinner.add(block)
    kept = thinner.arrays()
    assert kept is not None
    assert not thinner.thinned
    assert kept.v.tobytes() == reader.arrays().v.tobytes()
