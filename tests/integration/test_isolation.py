"""Runs on one machine do not hear each other."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from tests.support.follow import ended

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

DEADLINE = 90.0


def test_two_runs_at_once_leave_the_logs_of_two_runs_alone(tmp_path: Path) -> None:
    """With no domain given, each takes one for itself: equal topic names, and yet each file is as without ROS."""
    environment = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
    amplitudes = {"one": 5.0, "other": 7.0}
    overrides = {
        name: ["controller.law=computed_torque", "duration=50.0", f"reference.roll.amplitude_deg={amplitude}"]
        for name, amplitude in amplitudes.items()
    }
    command = [sys.executable, "-m", "space_robot_cli", "run", "liu2023/fig11", "--mode", "processes"]
    children = [
        subprocess.Popen(
            [*command, "--out", str(tmp_path / name), *(word for key in keys for word in ("--set", key))],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        for name, keys in overrides.items()
    ]
    with ended(children):
        said = [child.communicate(timeout=DEADLINE)[1] for child in children]
    # The verdict expects what the paper's own law reaches; here only the files count.
    assert {child.returncode for child in children} <= {0, 1}, said
    for name, keys in overrides.items():
        run_experiment(load_experiment("liu2023/fig11", keys), tmp_path / "alone" / name, mode="headless")
        flown, alone = (folder / name / f"{name}_0.mcap" for folder in (tmp_path, tmp_path / "alone"))
        assert flown.read_bytes() == alone.read_bytes()
