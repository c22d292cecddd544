"""A supervisor has thrusters unload the wheels: the task goes on, in every mode to the same bytes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.writer import MemorySink
from tests.support.replays import replayed

CASE = "point_to_point/unloading"
# Its wheels are full at 34 s, and empty at 45 s.
SHORT = {"duration": 60.0}


def run(**overrides: Any) -> MemorySink:
    """The shipped run, shortened."""
    found = run_in_memory(compose(load_experiment(CASE, SHORT | overrides)))
    assert isinstance(found, MemorySink)
    assert found.end_reason == "completed"
    return found


def held(sink: MemorySink) -> list[float]:
    """What the wheels hold at each tick [N m s]."""
    measured = [tick.sample.state.wheel_momentum for tick in sink.ticks]
    return [float(np.linalg.norm(one)) for one in measured if one is not None]


def off_by(sink: MemorySink) -> float:
    """Largest attitude error [rad]."""
    return max(float(np.linalg.norm(tick.output.telemetry["attitude_error"])) for tick in sink.ticks)


def test_full_wheels_are_unloaded_while_the_task_goes_on() -> None:
    """They are emptied and fill again; the error is what it is without, and momentum stays accounted for."""
    with_it, without = run(), run(supervision=None, expect={})
    modes = [tick.supervision.mode for tick in with_it.ticks if tick.supervision is not None]
    assert modes.index("UNLOAD") < modes.index("NOMINAL", modes.index("UNLOAD"))
    assert max(held(with_it)) < 21.0 < 35.0 < max(held(without))
    assert min(held(with_it)[modes.index("UNLOAD") :]) < 1.0
    assert off_by(with_it) < 1.001 * off_by(without)
    for sink in (with_it, without):
        assert max(float(np.abs(tick.sample.telemetry["momentum_residual"]).max()) for tick in sink.ticks) < 1e-8


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_it_is_the_same_in_a_graph_and_replays_equal(tmp_path: Path) -> None:
    """Byte for byte, with what all sides say again."""
    pytest.importorskip("rclpy")
    experiment = load_experiment(CASE, {"duration": 36.0})
    for mode in ("headless", "graph"):
        run_experiment(experiment, tmp_path / mode, mode=mode)
    logs = [(tmp_path / mode / f"{mode}_0.mcap").read_bytes() for mode in ("headless", "graph")]
    assert logs[0] == logs[1]
    assert [one.first for one in replayed(tmp_path / "graph").outcomes] == [None] * 3


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"robot": "mini"}, r"supervision.modes.UNLOAD.unload: no thrusters unload the wheels of this robot"),
        ({"plant.sensors.wheel_momentum": None}, r"supervision.modes.UNLOAD.unload: needs a reading of the wheels"),
    ],
)
def test_what_cannot_unload_is_refused(overrides: dict[str, Any], said: str) -> None:
    """Before anything runs, with the key."""
    with pytest.raises(SpecError, match=said):
        compose(load_experiment(CASE, overrides))
