"""A log as a Rerun recording: every signal under its name, the robot's bodies, and what happened."""

from __future__ import annotations

from pathlib import Path

import pytest

rerun = pytest.importorskip("rerun")
chunk = pytest.importorskip("rerun.chunk")

from space_robot_bringup.logs.foreign_log import read_shown  # noqa: E402
from space_robot_msgs_py.errors import LogError  # noqa: E402
from space_robot_report.rerun_recording import write_rerun  # noqa: E402
from tests.support.replays import record_run  # noqa: E402

WATCHED = (
    "duration=1.0",
    "expect={}",
    "supervision=mini_basic",
    "faults=[{kind: joint_stuck, joint: joint1, at: 0.5}]",
)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One second with a supervisor and a fault."""
    return record_run(tmp_path_factory.mktemp("logs") / "run", "liu2023/fig08", *WATCHED)


def test_a_recording_has_every_signal_by_name(log: Path, tmp_path: Path) -> None:
    """Attitude in degrees, joints, telemetry with the names of its numbers, bodies, modes and faults."""
    judged = read_shown(log)
    assert write_rerun(judged, tmp_path / "run.rrd") == judged.troubles
    reader = chunk.RrdReader(tmp_path / "run.rrd")
    paths = {one.entity_path for one in reader.stream()}
    joints = judged.header.joint_names
    wanted = [["attitude [deg]", kind, "yaw"] for kind in ("measured", "desired")]
    wanted += [[*place, name] for place in (["joints", "measured"], ["plant", "applied_effort"]) for name in joints]
    wanted += [["robot", name] for name in joints] + [["happened", "events"], ["happened", "modes"]]
    assert {rerun.new_entity_path(path) for path in wanted} <= paths
    assert len(list(reader.blueprints())) == 1


def test_a_recording_that_cannot_be_written_is_one_line(log: Path, tmp_path: Path) -> None:
    """A folder that is not there."""
    with pytest.raises(LogError, match="the recording cannot be written"):
        write_rerun(read_shown(log), tmp_path / "no" / "run.rrd")
