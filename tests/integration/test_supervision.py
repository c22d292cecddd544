"""Supervised runs: a fault, a monitor, a mode, a response; the same bytes in every mode, and replayed exactly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.false_alarms import watch
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_description.share import shipped
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.reader import LogReader
from tests.support.tool import Tool, refused

# A push that the wheels can take turns the satellite faster than its task ever does; then it is left alone.
FAULTS = [
    {"kind": "wrench_pulse", "torque": [0, 0, 1.2], "at": 8.0, "for": 1.0},
    {"kind": "sensor_frozen", "channel": "angular_velocity", "at": 30.0, "for": 3.0},
]
# Their momentum counts as a monitored value; for a while the reading stands still.
WHEELS: dict[str, Any] = {
    "plant.sensors.wheel_momentum": {"noise": 1e-5},
    "faults": [*FAULTS, {"kind": "sensor_frozen", "channel": "wheel_momentum", "at": 20.0, "for": 3.0}],
}


def experiment(**overrides: Any) -> Experiment:
    """The orientation task of `mini` with faults, under the shipped table."""
    keys = {"duration": 40.0, "faults": FAULTS, "supervision": "mini_basic"}
    return load_experiment("liu2023/fig08", keys | overrides)


def logged(place: Path, mode: Mode = "headless", **overrides: Any) -> bytes:
    """The log of such a run."""
    result = run_experiment(experiment(**overrides), place / "run", mode=mode)
    assert result.end_reason == "completed"
    return (place / "run" / "run_0.mcap").read_bytes()


def events(tick: Tick) -> tuple[DiagnosticEvent, ...]:
    """What was found at a tick."""
    return () if tick.supervision is None else tick.supervision.events


def modes(ticks: list[Tick]) -> list[tuple[float, str]]:
    """(time, change) of every change of mode."""
    return [(t.stamp / 1e9, one.message) for t in ticks for one in events(t) if one.name == "mode"]


def test_a_push_leads_to_safe_and_on_to_hold(tmp_path: Path) -> None:
    """The rate is seen, the mode changes, the damper brings it down, the robot holds where it is; all is reported."""
    logged(tmp_path)
    ticks = list(LogReader(tmp_path / "run").ticks())
    changes = modes(ticks)
    assert [change for _, change in changes] == ["NOMINAL -> SAFE", "SAFE -> HOLD"]
    assert 8.0 < changes[0][0] < 10.0
    reported = [one.name for tick in ticks for one in events(tick) if one.message == "fires"]
    assert reported == ["tumbling", "still", "gyro_frozen"]
    rates = np.array([np.linalg.norm(tick.sample.telemetry["true_velocity"][3:6]) for tick in ticks])
    assert rates.max() > 0.3
    assert rates[-1] < 0.01
    laws = [tick.output.telemetry["active_law"][0] for tick in ticks]
    assert [laws[0], laws[-1]] == [0.0, 0.0]
    assert len(set(laws)) == 2


def test_a_supervised_run_replays_equal_and_a_changed_threshold_is_found(tmp_path: Path) -> None:
    """Controller, supervisor and plant repeat the log; of a threshold 1 % off the first event that differs is named."""
    logged(tmp_path, **WHEELS)
    replayed = replay(tmp_path / "run", ReplayOptions())
    assert replayed.equal, [outcome.comparison.first for outcome in replayed.outcomes]
    order = ReplayOptions("supervisor", overrides={"supervision.monitors.0.above": 0.303})
    outcome = replay(tmp_path / "run", order).outcomes[0]
    assert not outcome.equal
    assert "tumbling fires" in str(outcome.first)


def test_without_faults_no_mode_changes() -> None:
    """The task itself, with noise, is no reason to leave NOMINAL."""
    noise = {f"plant.sensors.{name}.noise": 1e-4 for name in ("angular_velocity", "joint_velocity", "attitude")}
    for law in ("computed_torque", "adaptive", "ntsmc", "pd"):
        sink = run_in_memory(compose(experiment(**{"faults": [], "controller.law": law} | noise)))
        assert sink.end_reason == "completed"
        assert modes(sink.ticks) == []


def test_a_supervisor_that_finds_nothing_changes_no_command() -> None:
    """Commands are, to the bit, those of the run without it."""
    watched, alone = (
        run_in_memory(compose(experiment(**{"faults": [], "duration": 10.0, "supervision": table}))).ticks
        for table in ("mini_basic", None)
    )
    for one, other in zip(watched, alone, strict=True):
        assert one.output.command.u.tobytes() == other.output.command.u.tobytes()


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_every_mode_decides_the_same(tmp_path: Path, mode: Mode) -> None:
    """One file, whatever carried the messages."""
    pytest.importorskip("rclpy")
    assert logged(tmp_path / mode, mode, **WHEELS) == logged(tmp_path / "headless", **WHEELS)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("supervision=mini_baisc", "no such supervision table"),
        ("supervision={modes: {A: {}}, start: B}", "supervision.start: no such mode"),
        ("supervision={modes: {A: {law: damped_hld}}, start: A}", "supervision.modes.A.law: no such shipped law"),
        ("supervision={modes: {A: {law: damped_hold, gains: {rte: 1}}}, start: A}", "supervision.modes.A"),
        (
            "supervision={modes: {A: {}}, start: A, monitors: [{name: m, value: base.rte, above: 1}]}",
            "supervision.monitors.0.value: no such value",
        ),
        (
            "supervision={modes: {A: {}}, start: A, monitors: [{name: m, value: telemetry.err, above: 1}]}",
            "supervision.monitors.0.value: no such block",
        ),
    ],
)
def test_bad_tables_are_refused_before_anything_runs(
    space_robot: Tool, tmp_path: Path, override: str, said: str
) -> None:
    """One line, exit code 2, no directory."""
    refused(space_robot("run", "liu2023/fig08", "--set", override, "--out", "run"), said)
    refused(space_robot("check", "liu2023/fig08", "--set", override), said)
    assert not (tmp_path / "run").exists()


def test_laws_in_standby_and_a_supervisor_exclude_each_other(space_robot: Tool) -> None:
    """Both would decide which law runs."""
    refused(space_robot("check", "switch/mini", "--set", "supervision=mini_basic"), "controller.standby")


def test_a_table_without_laws_goes_with_any_law() -> None:
    """Modes that only change the reference need no law of their own, whatever the experiment's is called."""
    keys = {"faults": [], "duration": 1.0, "controller.law": "none", "controller.gains": {}}
    sink = run_in_memory(
        compose(experiment(**keys, supervision={"modes": {"NOMINAL": {}, "HOLD": {"reference": "here"}}}))
    )
    assert sink.end_reason == "completed"


def test_a_table_may_stand_beside_the_experiment(tmp_path: Path) -> None:
    """A path is relative to the file; the resolved experiment has the content."""
    (tmp_path / "table.yaml").write_text("modes: {A: {}}\nstart: A\n", encoding="utf-8")
    (tmp_path / "mine.yaml").write_text("base: liu2023/fig08\nsupervision: table.yaml\n", encoding="utf-8")
    found = load_experiment(tmp_path / "mine.yaml")
    assert found.supervision is not None
    assert list(found.supervision.modes) == ["A"]
    compose(found)


@pytest.mark.parametrize("table", shipped("supervision"))
def test_dispersed_robots_with_noise_raise_no_alarm(table: str) -> None:
    """A slice of ``benchmarks.false_alarms``: nominal tasks, and the mode never changes."""
    for seed in range(2):
        watcher = watch(table, seed, 400)
        assert watcher.end_reason == "completed"
        assert watcher.modes == {"NOMINAL"}
