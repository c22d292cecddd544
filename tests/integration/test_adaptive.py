"""The adaptive controller as a node: simulator and controller in this process."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_description.inertia import inertial_parameters
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import running_graph

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

CASE = "liu2023/fig11"


@pytest.mark.parametrize("update", ["rls", "composite"])
def test_the_node_tracks_learns_and_equals_the_headless_run(tmp_path: Path, update: str) -> None:
    """In the graph the law follows the waves, finds Ixx of the base, and logs the same messages as without ROS."""
    overrides = (f"controller.gains.update={update}", "controller.gains.rls.reset=null")
    with running_graph(tmp_path / "graph" / "run", *overrides, experiment=CASE) as robot:
        robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
    reader = LogReader(tmp_path / "graph" / "run")
    arrays, late = reader.arrays(), 160
    error = np.degrees(np.linalg.norm(arrays.controller["euler_error"][late:], axis=1))
    assert error.max() < 0.02
    truth = inertial_parameters(compose(load_experiment(CASE, overrides)).truth)[0]
    estimate = arrays.controller["parameters"][:, :10]
    assert abs(estimate[0, 4] / truth[4] - 1.0) > 0.15
    assert abs(estimate[-1, 4] / truth[4] - 1.0) < 0.01
    assert {"sliding_variable", "innovation", "covariance_trace", "lyapunov_function"} <= arrays.controller.keys()
    run_experiment(load_experiment(CASE, overrides), tmp_path / "headless" / "run", mode="headless")
    assert list(LogReader(tmp_path / "headless" / "run").messages()) == list(reader.messages())
