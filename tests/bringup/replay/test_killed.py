"""Logs of runs that ended because a process was killed: equal, as far as they go."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.ends import of_process
from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogWriter
from tests.support.replays import record_run, replayed

TICKS, ALIVE = 9, 6
ANSWERS = {"base/wrench_command", "joint_command", "controller/telemetry"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds of fig08."""
    return record_run(tmp_path_factory.mktemp("logs") / "fig08", "liu2023/fig08", "duration=2.0")


def cut(whole: Path, place: Path, role: str) -> Path:
    """The log that is left when the process of a role is killed before the end."""
    reader = LogReader(whole)
    writer = LogWriter(place, reader.header)
    writer.write_description(reader.header.urdf)
    for tick, (stamp, parts) in enumerate(reader.stamps()):
        if role == "simulator" and tick >= ALIVE:
            break
        kept = parts.keys() - ANSWERS if tick >= ALIVE else parts.keys()
        writer.write_tick(stamp, {topic: parts[topic.name] for topic in LOGGED if topic.name in kept})
        if role == "controller" and tick == ALIVE:
            # Nothing answers this state any more.
            break
    writer.close(of_process(role, "ended with signal SIGKILL"))
    return place


@pytest.mark.parametrize("role", ["controller", "simulator"])
def test_a_killed_process_is_no_difference(whole: Path, tmp_path: Path, role: str) -> None:
    """What it would have computed next is in no log; law and plant are not said to be different for it."""
    assert len(list(LogReader(whole).stamps())) == TICKS
    done = replayed(cut(whole, tmp_path / "cut", role))
    assert [outcome.first for outcome in done.outcomes] == [None, None]
    assert [outcome.ticks for outcome in done.outcomes] == [ALIVE, ALIVE + (role == "controller")]
