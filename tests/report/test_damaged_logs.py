"""The page of what is left of a damaged log, and what is refused in one line."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

pytest.importorskip("plotly")
from space_robot_bringup.logs.assessed import read_judged
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_report.pages.log_report import write_log_report
from tests.support.report_pages import own_markup, recorded


def refusal_of(log: Path) -> str:
    """Why a log cannot be read; empty where it can."""
    try:
        read_judged(log)
    except SpaceRobotError as error:
        return str(error)
    return ""


@pytest.fixture(scope="module")
def plain(bag: Path) -> bytes:
    """The log as a kill would leave it: plain records, no index, no end."""
    reader = LogReader(bag)
    sink = LogSink(bag.parent / "plain", reader.header)
    for tick in reader.ticks():
        sink.record(tick)
    data = sink.writer.path.read_bytes()
    sink.close("interrupted")
    return data


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_of_a_truncated_log_what_is_left_is_shown(plain: bytes, tmp_path: Path, share: float) -> None:
    """A log that was never closed is shown up to its last complete tick, and the page says that it was cut."""
    path = tmp_path / "cut_0.mcap"
    path.write_bytes(plain[: int(len(plain) * share)])
    judged = write_log_report(path, tmp_path / "cut.html")
    assert judged.end_reason is None
    assert 0 < judged.arrays.time.size < 161
    text = own_markup((tmp_path / "cut.html").read_text(encoding="utf-8"))
    assert "the log was truncated" in text
    assert "FAIL" in text


def test_damaged_logs_are_shown_or_refused_in_one_line(bag: Path, tmp_path: Path) -> None:
    """With any of fifty bytes flipped, and cut at any of fifty places, a log makes a page or one clear error."""
    data, chance = next(bag.glob("*.mcap")).read_bytes(), random.Random(0)
    path = tmp_path / "damaged_0.mcap"
    shown = 0
    for number in range(100):
        place = chance.randrange(len(data))
        spoilt = data[:place] + (bytes([data[place] ^ 0x55]) + data[place + 1 :] if number % 2 else b"")
        path.write_bytes(spoilt)
        refusal = refusal_of(path)
        assert "\n" not in refusal
        shown += not refusal
    assert shown > 10


def test_a_chunk_that_is_damaged_costs_only_what_is_behind_it(tmp_path: Path) -> None:
    """A log of several chunks with a damaged one in the middle is shown up to there, and the page says why."""
    bag = recorded(tmp_path / "run", "liu2023/fig08", "duration=200.0", "expect={}")
    path = next(bag.glob("*.mcap"))
    data = bytearray(path.read_bytes())
    data[len(data) * 7 // 10] ^= 0xFF
    path.write_bytes(bytes(data))
    judged = write_log_report(bag, tmp_path / "run.html")
    assert 100 < judged.arrays.time.size < 801
    assert any("chunk is damaged" in trouble for trouble in judged.troubles)
