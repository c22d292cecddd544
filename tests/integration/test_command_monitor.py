"""Commands that the plant refuses in a run: in the log with their reason, the same in every mode, replayed exactly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.log.reader import LogReader

# The step at the start asks for more than half of the wheels, and for more than a small change.
MONITOR = {"limit": {"factor": 0.5, "response": "clip"}, "rate": {"factor": 0.03}}


def experiment(**overrides: Any) -> Experiment:
    """The orientation task of `mini` under a monitor that has to act."""
    return load_experiment("liu2023/fig08", {"duration": 5.0, "plant.monitor": MONITOR} | overrides)


def logged(place: Path, mode: Mode = "headless", **overrides: Any) -> bytes:
    """The log of such a run."""
    result = run_experiment(experiment(**overrides), place / "run", mode=mode)
    assert result.end_reason == "completed"
    return (place / "run" / "run_0.mcap").read_bytes()


@pytest.mark.parametrize("delay", [0, 1])
def test_what_was_refused_is_in_the_log_and_replays(tmp_path: Path, delay: int) -> None:
    """Refused commands did not act, each has an event with its stamp and count, and the plant repeats all of it."""
    logged(tmp_path, **{"plant.delay_periods": delay})
    reader = LogReader(tmp_path / "run")
    ticks = list(reader.ticks())
    reported = [(tick.stamp, event) for tick in ticks for event in tick.sample.events]
    refused = [(stamp, dict(event.values)) for stamp, event in reported if event.name == "command refused"]
    assert {event.name for _, event in reported} == {"command refused", "command clipped"}
    assert [int(values["count"]) for _, values in refused] == list(range(1, len(refused) + 1))
    acted = {int(tick.sample.telemetry["command_stamp"][0]) for tick in ticks}
    assert all(int(values["stamp"]) == stamp - 250_000_000 for stamp, values in refused)
    assert acted.isdisjoint(int(values["stamp"]) for _, values in refused)
    replayed = replay(tmp_path / "run", ReplayOptions())
    assert replayed.equal, [outcome.comparison.first for outcome in replayed.outcomes]


def test_another_threshold_is_found_by_replay(tmp_path: Path) -> None:
    """A bound that is 1 % off gives other events or states, and replay names the first."""
    logged(tmp_path)
    outcome = replay(
        tmp_path / "run", ReplayOptions("plant", overrides={"plant.monitor.limit.factor": 0.505})
    ).outcomes[0]
    assert not outcome.equal


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_every_mode_refuses_the_same(tmp_path: Path, mode: Mode) -> None:
    """One file, whatever carried the messages."""
    pytest.importorskip("rclpy")
    assert logged(tmp_path / mode, mode) == logged(tmp_path / "headless")


def test_other_plants_have_the_monitor_too(tmp_path: Path) -> None:
    """A plant with a grasp tells what it refused, and replays."""
    overrides = {"duration": 20.0, "plant.monitor": {"limit": {"factor": 1e-3}}, "plant.hold": {"last_for": 2}}
    result = run_experiment(load_experiment("song2023/pccs", overrides), tmp_path / "run", mode="headless")
    assert result.end_reason == "completed"
    assert any(tick.sample.events for tick in LogReader(tmp_path / "run").ticks())
    assert replay(tmp_path / "run", ReplayOptions("plant")).equal
