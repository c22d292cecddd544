"""What a log takes of memory while it is judged, drawn or looked at does not grow with its messages."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

from space_robot_bringup.logs import assessed, info
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.modes.run import judge_log
from space_robot_msgs_py.log import thinning
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import Thinner
from tests.support.long_logs import write_long_log

# Several blocks each, so that both have had all that one block takes; below some 2,000 ticks that is most of the peak.
FEW, MANY = 2_600, 4_600
# What judging keeps of a tick of a robot with four joints [bytes], see ``Measurement``, and what lists add.
KEPT = 200


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Logs of few and of many ticks."""
    place = tmp_path_factory.mktemp("long")
    for count in (FEW, MANY):
        write_long_log(place / str(count), count)
    return place / str(FEW), place / str(MANY)


def judged(log: Path) -> None:
    reader = LogReader(log)
    composition = info.compose_logged(info.logged_experiment(reader.header.experiment))
    result = judge_log(log, composition, "completed", 0.0)
    assert result.metrics is not None
    assert result.passed is not False


def drawn(log: Path) -> None:
    found = read_judged(log)
    assert found.metrics is not None
    assert found.arrays.stamp.size < found.ticks == found.metrics.ticks


def looked_at(log: Path) -> None:
    assert bag_info(log).by_index


def peak(use: Callable[[Path], None], log: Path) -> int:
    """The most memory that was allocated at once [bytes]."""
    use(log)
    tracemalloc.start()
    try:
        use(log)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(("use", "kept"), [(judged, KEPT), (drawn, KEPT), (looked_at, 20)])
def test_memory_does_not_grow_with_the_messages_of_a_log(
    logs: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch, use: Callable[[Path], None], kept: int
) -> None:
    """Thousands of ticks more take no more at once than the few numbers that are kept of each."""
    monkeypatch.setattr(info, "LARGE", 0)
    monkeypatch.setattr(assessed, "Thinner", lambda: Thinner(most=200))
    # Extremes of 196 columns would be nearly every tick of logs as short as these.
    monkeypatch.setattr(thinning, "MAX_COLUMNS", 5)
    few, many = (peak(use, log) for log in logs)
    of_a_tick = (many - few) / (MANY - FEW)
    messages = sum(len(data) for _, _, data in LogReader(logs[0]).messages()) / FEW
    assert of_a_tick < kept < messages / 15


READING = """
import sys
from pathlib import Path
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info
assert bag_info(Path(sys.argv[1]), full=True).verdict.passed is None
assert read_judged(sys.argv[1]).metrics.ticks == int(sys.argv[2])
print(*sorted({"numba", "scipy", "space_robot_control.laws.base"} & sys.modules.keys()))
"""


def test_reading_a_log_loads_no_law_and_no_compiler(logs: tuple[Path, Path]) -> None:
    """A log is judged with Pinocchio and NumPy alone: the 90 MB of a law and its compiler are not loaded."""
    words = [sys.executable, "-c", READING, str(logs[0]), str(FEW)]
    assert subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip() == ""


def test_the_verdict_of_a_thinned_log_is_that_of_all_its_ticks(
    logs: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """However few ticks are drawn all are judged, to the same bits, and the page says so."""
    whole = read_judged(logs[0])
    monkeypatch.setattr(assessed, "Thinner", lambda: Thinner(most=200))
    thinned = read_judged(logs[0])
    assert thinned.arrays.stamp.size < whole.arrays.stamp.size == thinned.ticks == FEW
    assert whole.metrics is not None
    assert thinned.metrics is not None
    assert thinned.metrics.flat() == whole.metrics.flat()
    assert thinned.checks == whole.checks
    assert whole.troubles == ()
    (said,) = thinned.troubles
    assert f"{FEW} ticks" in said
