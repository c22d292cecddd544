"""A run with five faults, three mode changes and commands of the ground: the same in every mode, replayed exactly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.supervision import ModeController
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.recording import Code
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.reader import LogReader

FAULTS = [
    {"kind": "joint_effectiveness", "joint": "joint2", "factor": 0.7, "at": 3.0},
    {"kind": "wrench_pulse", "torque": [0, 0, 1.2], "at": 8.0, "for": 1.0},
    {"kind": "link_delay", "topic": "state", "periods": 1, "at": 12.0, "for": 1.0},
    {"kind": "sensor_frozen", "channel": "angular_velocity", "at": 30.0, "for": 3.0},
    {"kind": "controller_restarted", "at": 34.0},
]
SCHEDULE = [{"at": 25.0, "do": "nominal"}, {"at": 26.0, "do": "nominal"}, {"at": 36.0, "do": "hold"}]
CLIPPING = {"limit": {"factor": 0.5, "response": "clip"}, "rate": {"factor": 1.0}}
COUNT = {"name": "clipped", "value": "command.clipped", "above": 0.5, "severity": "low"}


def experiment(**overrides: Any) -> Experiment:
    """The orientation task of `mini`, everything at once."""
    table = load_experiment("liu2023/fig08", {"supervision": "mini_basic"}).supervision
    assert table is not None
    data = table.model_dump(mode="json", by_alias=True)
    # At rest before the commands of the ground come.
    data["modes"]["SAFE"]["law"] = "detumble"
    data |= {"schedule": SCHEDULE, "monitors": [*data["monitors"], COUNT]}
    keys = {"duration": 40.0, "faults": FAULTS, "plant.monitor": CLIPPING, "supervision": data}
    return load_experiment("liu2023/fig08", keys | overrides)


def logged(place: Path, mode: Mode = "headless", **overrides: Any) -> bytes:
    """The log of such a run."""
    result = run_experiment(experiment(**overrides), place / "run", mode=mode)
    assert result.end_reason == "completed"
    return (place / "run" / "run_0.mcap").read_bytes()


def found(ticks: list[Tick], name: str) -> list[tuple[float, str]]:
    """(time, message) of the events of a name."""
    pairs = [(tick.stamp / 1e9, one) for tick in ticks if tick.supervision for one in tick.supervision.events]
    return [(time, one.message) for time, one in pairs if one.name == name]


def test_commands_monitors_and_faults_meet_and_replay(tmp_path: Path) -> None:
    """All of it is in the log; controller, plant and supervisor repeat it to the bit."""
    logged(tmp_path)
    ticks = list(LogReader(tmp_path / "run").ticks())
    assert [change for _, change in found(ticks, "mode")] == [
        "NOMINAL -> SAFE",
        "SAFE -> HOLD",
        "HOLD -> NOMINAL",
        "NOMINAL -> HOLD",
    ]
    assert found(ticks, "command") == [(25.0, "accepted"), (26.0, "refused"), (36.0, "accepted")]
    assert found(ticks, "clipped")[0] == (0.25, "fires")
    assert [tick.supervision.mode for tick in ticks if tick.supervision][-1] == "HOLD"
    assert [t.stamp for t in ticks if t.supervision and t.supervision.housekeeping] == [k * 10**10 for k in range(5)]
    replayed = replay(tmp_path / "run", ReplayOptions())
    assert [one.against for one in replayed.outcomes] == ["controller", "plant", "supervisor"]
    assert replayed.equal, [one.comparison.first for one in replayed.outcomes]


def test_a_threshold_that_is_1_percent_off_is_found(tmp_path: Path) -> None:
    """Replay names the first event that differs, with its stamp; controller and plant are as they were."""
    logged(tmp_path)
    replayed = replay(tmp_path / "run", ReplayOptions(overrides={"supervision.monitors.0.above": 0.303}))
    equal = {one.against: one.equal for one in replayed.outcomes}
    assert equal == {"controller": True, "plant": True, "supervisor": False}
    first = replayed.outcomes[-1].first
    assert first is not None
    assert (first.topic, first.field) == ("events", "events")
    assert "tumbling fires" in str(first.recorded)
    assert 8.0 < first.stamp / 1e9 < 10.0


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_every_mode_logs_the_same(tmp_path: Path, mode: Mode) -> None:
    """One file, whatever carried the messages."""
    pytest.importorskip("rclpy")
    assert logged(tmp_path / mode, mode) == logged(tmp_path / "headless")


def test_the_mode_decides_what_is_followed() -> None:
    """In HOLD the law follows the configuration measured at the entry, at rest; in NOMINAL guidance again."""
    ticks = run_in_memory(compose(experiment())).ticks
    held = [tick for tick in ticks if tick.supervision and tick.supervision.mode == "HOLD" and tick.stamp < 25e9]
    entry = held[0]
    assert entry.supervision is not None
    assert entry.supervision.since == entry.stamp
    for tick in held:
        off = entry.sample.state.q[7:] - tick.sample.state.q[7:]
        assert tick.output.telemetry["joint_error"].tobytes() == off.tobytes()
    back = next(tick for tick in ticks if tick.stamp == 25_000_000_000)
    off = back.reference.q[7:] - back.sample.state.q[7:]
    assert back.output.telemetry["joint_error"].tobytes() == off.tobytes()


def test_runs_without_supervision_have_nothing_of_it() -> None:
    """No supervisor, an ordinary controller, no topic."""
    composition = compose(load_experiment("liu2023/fig08", {"duration": 5.0}))
    assert composition.supervisor() is None
    assert not isinstance(composition.controller(), ModeController)
    assert composition.optional_topics == ()


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_a_law_that_gives_up_leaves_the_mode_it_was_in(tmp_path: Path) -> None:
    """The last state has a mode and no command, the same in both modes; every side repeats the end."""
    pytest.importorskip("rclpy")
    table = {"modes": {"NOMINAL": {}, "SAFE": {"law": "damped_hold"}}}
    keys: dict[str, Any] = {"duration": 5.0, "supervision": table, "controller.gains": {}}
    failing = load_experiment("liu2023/fig08", keys | {"controller.law": "tests.support.laws:GivesUp"})
    logs = []
    for mode in ("headless", "graph"):
        assert run_experiment(failing, tmp_path / mode / "run", mode=mode).end_reason.startswith("controller: gives_up")
        logs.append((tmp_path / mode / "run" / "run_0.mcap").read_bytes())
    assert logs[0] == logs[1]
    assert replay(tmp_path / "headless" / "run", ReplayOptions(code=Code(allowed=True))).equal
