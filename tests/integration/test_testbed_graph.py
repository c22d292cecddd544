"""The model-free controller and the testbed as ROS nodes: the same run, the same log, telemetry in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import Spawn
from tests.support.logged_law import law_of

pytest.importorskip("rclpy")
from tests.support.executables import run_beside

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

MFAC = {"output", "pseudo_gradient", "innovation", "resets", "gate_count", "saturated", "saturation_share"}


def test_the_testbed_graph_equals_the_headless_run(tmp_path: Path) -> None:
    """Headless and graph log equal bits for a plant of the second kind under noise, delay and outliers."""
    experiment = load_experiment("song2023/attitude_6_85", ["duration=8.0", "plant.camera.outlier_share=0.05"])
    logs = []
    for mode in ("headless", "graph"):
        result = run_experiment(experiment, tmp_path / mode / "run", mode=mode)  # type: ignore[arg-type]
        assert result.end_reason == "completed"
        (log,) = (tmp_path / mode / "run").glob("*.mcap")
        logs.append(log.read_bytes())
    assert logs[0] == logs[1]


def test_the_telemetry_of_law_and_grasp_is_in_the_log(tmp_path: Path) -> None:
    """What the law believes and what the grasp carries can be read back from the log, tick by tick."""
    experiment = load_experiment("song2023/attitude_6_85", ["duration=3.0"])
    run_experiment(experiment, tmp_path / "run", mode="graph")
    ticks = list(LogReader(tmp_path / "run").ticks())
    assert len(ticks) == 31
    assert set(ticks[-1].output.telemetry.labels) >= MFAC
    assert {"grasp_effort", "grasp_energy", "command_ignored"} <= set(ticks[-1].sample.telemetry.labels)
    assert ticks[-1].output.telemetry["pseudo_gradient"][0] == pytest.approx(0.1 * 8.05 / 160.6, rel=0.01)
    assert np.abs(ticks[-1].sample.telemetry["grasp_effort"][2]) > 0.0


def test_the_executable_runs_the_testbed(tmp_path: Path, spawn: Spawn) -> None:
    """``mfac_controller`` with simulator, guidance and recorder beside it runs an experiment to its end."""
    run = tmp_path / "run"
    common = ["--experiment", "song2023/attitude_1_7", "--out", str(run), "--set", "duration=2.0"]
    run_beside(spawn, "space_robot_control/mfac_controller", common)
    reader = LogReader(run)
    assert reader.end_reason == "completed"
    assert law_of(reader.header.experiment) == "mfac"
    assert "pseudo_gradient" in reader.arrays().controller
