"""A law that has no answer under supervision: the law of another mode answers, and the mode follows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.events import LAW_FAILED
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.reader import LogReader

# A gyro of which the adaptive law learns that the robot has less than no mass.
LIE = {"kind": "sensor_scale", "channel": "angular_velocity", "factor": -3.0, "at": 1.0, "for": 2.0}


def experiment(**overrides: Any) -> Experiment:
    """The adaptive law on `mini`, and nothing but its failure leads out of NOMINAL."""
    modes = {"NOMINAL": {}, "HOLD": {"reference": "here", "forget": True}, "SAFE": {"law": "detumble"}}
    monitors = [
        {"name": "law_failed", "value": "telemetry.law_failed", "above": 0.5, "in": ["NOMINAL"], "to": "SAFE"},
        {"name": "still", "value": "base.rate", "below": 1.0, "for": 40, "in": ["SAFE"], "to": "HOLD", "times": 1},
    ]
    table = {"modes": modes, "monitors": monitors, "fallback": "SAFE"}
    keys = {"duration": 14.0, "faults": [LIE], "supervision": table, "controller.gains.update": "rls"}
    return load_experiment("liu2023/fig08", keys | overrides)


def failures(ticks: list[Tick]) -> list[int]:
    """Stamps at which a law failed."""
    return [event.stamp for tick in ticks for event in tick.output.events if event.kind == LAW_FAILED]


def test_another_law_answers_where_that_of_the_experiment_cannot() -> None:
    """At the same tick, with an event that has the reason; the monitor leads on, and what was learned is forgotten."""
    ticks = run_in_memory(compose(experiment())).ticks
    (failed,) = failures(ticks)
    changes = {t.stamp: event.message for t in ticks if t.supervision for event in t.supervision.events}
    period = ticks[1].stamp
    assert changes[failed + period] == "NOMINAL -> SAFE"
    assert "SAFE -> HOLD" in changes.values()
    by_stamp = {tick.stamp: tick.output.telemetry for tick in ticks}
    assert [by_stamp[failed + i * period]["law_failed"][0] for i in (-1, 0, 1)] == [0.0, 1.0, 0.0]
    assert by_stamp[failed]["active_law"][0] == 1.0
    back = next(stamp for stamp, message in changes.items() if message == "SAFE -> HOLD")
    learned = [by_stamp[stamp]["adaptive.parameters"] for stamp in (0, back, failed - period)]
    assert np.array_equal(learned[0], learned[1])
    assert not np.array_equal(learned[0], learned[2])


def test_without_a_fallback_the_run_ends_as_before() -> None:
    """With the law's own words."""
    table = {"modes": {"NOMINAL": {}, "SAFE": {"law": "detumble"}}}
    sink = run_in_memory(compose(experiment(supervision=table)))
    assert "no longer positive" in str(sink.end_reason)


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_every_mode_falls_back_alike_and_it_replays(tmp_path: Path) -> None:
    """One file, whatever carried the messages; controller, supervisor and plant repeat it."""
    pytest.importorskip("rclpy")
    modes: tuple[Mode, ...] = ("headless", "graph")
    for mode in modes:
        assert run_experiment(experiment(), tmp_path / mode / "run", mode=mode).end_reason == "completed"
    logs = [(tmp_path / mode / "run" / "run_0.mcap").read_bytes() for mode in modes]
    assert logs[0] == logs[1]
    assert failures(list(LogReader(tmp_path / "headless" / "run").ticks()))
    replayed = replay(tmp_path / "headless" / "run", ReplayOptions())
    assert replayed.equal, [outcome.comparison.first for outcome in replayed.outcomes]
