"""The executables that a package offers beside ``controller``, each with its own law."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import Spawn
from tests.support.logged_law import law_of

pytest.importorskip("rclpy")
from tests.support.executables import run_beside

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize(("name", "block"), [("adaptive", "parameters"), ("ntsmc", "adaptive_gain")])
def test_the_executable_runs_an_experiment_of_another_law(tmp_path: Path, spawn: Spawn, name: str, block: str) -> None:
    """With simulator, guidance and recorder beside it, the executable runs its law, and the log has its telemetry."""
    run = tmp_path / "run"
    common = ["--experiment", "point_to_point/ur5_sat", "--out", str(run), "--set", "duration=5.0"]
    law = ["--set", f"controller.law={name}"]
    run_beside(spawn, f"space_robot_control/{name}_controller", common, others=law)
    reader = LogReader(run)
    assert reader.end_reason == "completed"
    assert law_of(reader.header.experiment) == name
    assert block in reader.arrays().controller
