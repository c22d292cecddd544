"""A flexible robot in the three modes, replayed, and in a campaign: the same bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.log.reader import LogReader

MODES: tuple[Mode, ...] = ("graph", "processes")


def flexible() -> Experiment:
    """Panels, fuel and gears, their motors measured with noise; two seconds."""
    changes = ["duration=2.0", "plant.flexibility.joints.measured=motor", "plant.delay_periods=1"]
    noise = "plant.sensors.joint_position={noise: 1.0e-5, quantisation: 1.0e-6}"
    return load_experiment("flexible/servicer", [*changes, noise])


def bag(directory: Path) -> bytes:
    (log,) = directory.glob("*.mcap")
    return log.read_bytes()


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run without ROS."""
    directory = tmp_path_factory.mktemp("truth") / "run"
    assert run_experiment(flexible(), directory, mode="headless").end_reason == "completed"
    return directory


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", MODES)
def test_a_flexible_robot_logs_the_same_in_every_mode(truth: Path, tmp_path: Path, mode: Mode) -> None:
    """What is hidden from laws and sensors is in the same log, byte by byte."""
    pytest.importorskip("rclpy")
    assert run_experiment(flexible(), tmp_path / "run", mode=mode).end_reason == "completed"
    assert bag(tmp_path / "run") == bag(truth)


def test_a_flexible_robot_replays_equal(truth: Path) -> None:
    """The header says what is flexible: plant and law repeat the run from the log alone."""
    replayed = replay(truth, ReplayOptions())
    assert replayed.equal, [str(outcome.first) for outcome in replayed.outcomes]
    assert {outcome.against for outcome in replayed.outcomes} >= {"plant"}
    *_, last = LogReader(truth).ticks()
    assert last.sample.telemetry["flexible_panel_left"].size == 2
    assert last.sample.telemetry["flexible_energy"][0] > 0.0


def test_campaigns_run_a_flexible_robot_tick_by_tick() -> None:
    """The compiled loop leaves it to the one that writes every block."""
    assert compiled_run(compose(flexible())) is None
