"""The adaptive controller as a node: simulator and controller in this process, and as the executable of the package."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.compose import compose
from space_robot_bringup.experiment import load_experiment
from space_robot_bringup.graph import reserved_domain
from space_robot_bringup.run import run_experiment
from space_robot_description.inertia import inertial_parameters
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.log_reader import LogReader
from tests.integration.harness import flight

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

CASE = "liu2023/fig11"
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("update", ["rls", "composite"])
def test_the_node_tracks_learns_and_equals_the_headless_flight(tmp_path: Path, update: str) -> None:
    """In the graph the law follows the waves, finds Ixx of the base, and logs the same messages as without ROS."""
    overrides = (f"controller.gains.update={update}", "controller.gains.rls.reset=null")
    with flight(tmp_path / "graph" / "run", *overrides, experiment=CASE) as robot:
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


def test_the_executable_flies_an_experiment_of_another_law(tmp_path: Path) -> None:
    """``adaptive_controller`` with simulator, guidance and recorder beside it: the log has the law's telemetry."""
    run = tmp_path / "run"
    common = ["--experiment", "point_to_point/ur5_sat", "--out", str(run), "--set", "duration=5.0"]
    law = ["--set", "controller.law=adaptive"]
    nodes = {"space_robot_sim": ("recorder", "simulator"), "space_robot_control": ("guidance", "adaptive_controller")}
    with reserved_domain() as domain:
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain), "PATH": f"{_bin()}:{os.environ['PATH']}"}
        children = [
            subprocess.Popen(
                ["sh", str(ROOT / "lib" / package / name), *common, *(law if name != "adaptive_controller" else [])],
                env=environment,
                stderr=subprocess.PIPE,
                text=True,
            )
            for package, names in nodes.items()
            for name in names
        ]
        said = [child.communicate(timeout=60)[1] for child in children]
    assert [child.returncode for child in children] == [0, 0, 0, 0], said
    reader = LogReader(run)
    assert reader.end_reason == "completed"
    assert law_of(reader.header.experiment) == "adaptive"
    assert "parameters" in reader.arrays().controller


def law_of(text: str) -> str:
    """The law a log says it was flown by."""
    return str(parse_yaml_text(text, "log")["controller"]["law"])


def _bin() -> Path:
    """Where ``python3`` is this interpreter: in the source tree the executables have none beside them."""
    return Path(sys.executable).parent
