"""Runs on one machine do not hear each other."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import DEADLINE, await_ticks, ended
from tests.support.forks import Fork, fork_main

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

SHORT = "duration=50.0"
PLANS = {
    "long": ["controller.law=computed_torque", "reference.roll.amplitude_deg=5.0"],
    "short": ["controller.law=computed_torque", "reference.roll.amplitude_deg=7.0"],
}


def test_two_runs_at_once_leave_the_logs_of_two_runs_alone(tmp_path: Path) -> None:
    """With no domain given, each takes one for itself: equal topic names, and yet each log is as without ROS.

    One is a graph that runs all the time, the other is run by processes meanwhile.
    """
    environment = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}

    def start(name: str, mode: str, duration: str) -> Fork:
        sets = [word for key in (*PLANS[name], duration) for word in ("--set", key)]
        command = ["run", "liu2023/fig11", "--mode", mode, "--out", str(tmp_path / name), *sets]
        return fork_main("space_robot_cli.main", *command, environment=environment)

    with ended([start("long", "graph", "duration=250000.0")]) as (long,):
        await_ticks(tmp_path / "long", 10, long, DEADLINE)
        with ended([start("short", "processes", SHORT)]) as (short,):
            said = short.communicate(DEADLINE)[1]
        assert long.poll() is None
        long.send_signal(signal.SIGINT)
        # The verdict expects what the paper's own law reaches; here only the logs count.
        assert (short.returncode, long.wait(DEADLINE)) == (1, 1), said
    for name, keys in PLANS.items():
        run_experiment(load_experiment("liu2023/fig11", [*keys, SHORT]), tmp_path / "alone" / name, mode="headless")
        alone, beside = (list(LogReader(place / name).messages()) for place in (tmp_path / "alone", tmp_path))
        assert len(alone) > 2000
        assert beside[: len(alone)] == alone
    assert LogReader(tmp_path / "short").end_reason == "completed"
