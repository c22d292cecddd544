"""Around a wheel that failed: the wheels that are left give its part of the torque, in a mode that says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.run import run_experiment
from space_robot_control.command_limits import CommandLimits
from space_robot_control.reallocation import Reallocation
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.log.writer import MemorySink
from tests.support.replays import replayed

# Its four wheels are a pyramid.
CASE, FAILED = "point_to_point/panda_sat", 1
FAULT = {"kind": "wheel_stopped", "wheel": FAILED, "at": 6.0}
AROUND = {"HOLD": {"reference": "follow", "wheels_off": [FAILED]}}
PLAN = {"schedule": [{"at": 8.0, "do": "hold"}]}


def run(**mode: Any) -> MemorySink:
    """A slew in which a wheel stops, and two seconds later the mode changes."""
    table = {"modes": {"NOMINAL": {}, "HOLD": {"reference": "follow"} | mode}} | PLAN
    found = run_in_memory(compose(load_experiment(CASE, {"duration": 24.0, "faults": [FAULT], "supervision": table})))
    assert isinstance(found, MemorySink)
    assert found.end_reason == "completed"
    return found


def off_by(sink: MemorySink, begin: float) -> float:
    """Largest attitude error from a time on [rad]."""
    ticks = [tick for tick in sink.ticks if tick.stamp >= begin * 1e9]
    return max(float(np.linalg.norm(tick.output.telemetry["attitude_error"])) for tick in ticks)


def test_commands_around_a_wheel_give_the_torque_of_all() -> None:
    """To rounding, whatever the torque: what the others give of it is what was wanted, and forces stay as they are."""
    robot = load_robot("panda_sat")
    limits, around = CommandLimits(robot), Reallocation(robot, [FAILED], "k")
    left = [wheel for wheel in range(4) if wheel != FAILED]
    for wrench in np.random.default_rng(1).normal(size=(20, 6)):
        sent = around.command(Command(5, wrench, np.arange(float(robot.n))))
        given = limits.axes[:, left] @ limits.share[left] @ sent.wrench[3:]
        np.testing.assert_allclose(given, wrench[3:], atol=1e-12)
        assert sent.stamp == 5
        assert sent.wrench[:3].tolist() == wrench[:3].tolist()
        assert sent.effort.tolist() == [*range(robot.n)]


def test_a_robot_with_a_wheel_less_follows_as_with_all() -> None:
    """With the mode the error is a part of what it is without; momentum stays balanced through all of it."""
    with_it, without = run(wheels_off=[FAILED]), run()
    assert off_by(with_it, 14.0) < 0.3 * off_by(without, 14.0)
    for sink in (with_it, without):
        assert max(float(np.abs(tick.sample.telemetry["momentum_residual"]).max()) for tick in sink.ticks) < 1e-9


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_it_is_the_same_in_a_graph_and_replays_equal(tmp_path: Path) -> None:
    """Byte for byte, with what all sides say again."""
    pytest.importorskip("rclpy")
    table = {"modes": {"NOMINAL": {}} | AROUND} | PLAN
    spec = load_experiment(CASE, {"duration": 10.0, "faults": [FAULT], "supervision": table})
    places = [tmp_path / mode for mode in ("headless", "graph")]
    for place in places:
        assert run_experiment(spec, place, mode=place.name).end_reason == "completed"  # type: ignore[arg-type]
    logs = [(place / f"{place.name}_0.mcap").read_bytes() for place in places]
    assert logs[0] == logs[1]
    done = replayed(places[0])
    assert [(one.against, one.first) for one in done.outcomes] == [
        (against, None) for against in ("controller", "plant", "supervisor")
    ]


@pytest.mark.parametrize(
    ("case", "off", "key", "said"),
    [
        (CASE, [4], "supervision.modes.HOLD.wheels_off", "0 to 3"),
        (CASE, [0, 1], "supervision.modes.HOLD.wheels_off", "span space"),
        ("liu2023/fig08", [0], "supervision.modes.HOLD.wheels_off", "span space"),
        ("compare/servicer", [0], "supervision.modes.HOLD.wheels_off", "reaction wheels"),
    ],
)
def test_wheels_that_cannot_be_left_out_are_refused(case: str, off: list[int], key: str, said: str) -> None:
    """None of that index, or one without which the others cannot turn the base about every axis."""
    table = {"modes": {"NOMINAL": {}, "HOLD": {"wheels_off": off}}}
    with pytest.raises(SpecError, match=said) as caught:
        compose(load_experiment(case, {"supervision": table}))
    assert caught.value.key == key


def test_momentum_of_the_wheels_is_not_reckoned_from_such_commands() -> None:
    """It needs a reading: the commands are meant for some of the wheels."""
    rows = [{"name": "full", "value": "wheels.momentum", "above": 40.0}]
    table = {"modes": {"NOMINAL": {}} | AROUND, "monitors": rows}
    with pytest.raises(SpecError, match="needs a reading"):
        compose(load_experiment(CASE, {"supervision": table}))
    compose(load_experiment(CASE, {"supervision": table, "plant.sensors.wheel_momentum": {"noise": 0.0}}))
