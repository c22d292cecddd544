"""Experiments whose wheels are measured, and what all others keep."""

from __future__ import annotations

from typing import Any

import pytest

import space_robot as sr
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment, to_yaml
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_msgs_py.log.arrays import arrays_of
from space_robot_msgs_py.topics import WHEEL_MOMENTUM
from tests.support.tool import Tool, refused

IDEAL: dict[str, Any] = {"plant.sensors.wheel_momentum": {}}


def experiment(**keys: Any) -> Experiment:
    """A second of the orientation task of mini."""
    return load_experiment("liu2023/fig08", {"duration": 1.0} | keys)


def test_the_reading_is_there_only_where_it_is_asked_for() -> None:
    """Without the key neither the resolved experiment nor the header of the log has a word of it; null is no key."""
    for without in (experiment(), experiment(**{"plant.sensors.wheel_momentum": None})):
        assert "wheel_momentum" not in to_yaml(without)
        assert WHEEL_MOMENTUM.name not in compose(without).header.topics
    measured = experiment(**IDEAL)
    assert load_experiment("liu2023/fig08", {"plant": measured.plant.model_dump()}).plant == measured.plant
    assert WHEEL_MOMENTUM.name in compose(measured).header.topics


def test_an_ideal_reading_is_the_momentum_of_the_wheels() -> None:
    """The state has the truth of the telemetry, from the first tick on; without the key it has none."""
    for tick in run_in_memory(compose(experiment(**IDEAL))).ticks:
        assert tick.sample.state.wheel_momentum is not None
        assert tick.sample.state.wheel_momentum.tolist() == tick.sample.telemetry["wheel_momentum"].tolist()
    assert all(tick.sample.state.wheel_momentum is None for tick in run_in_memory(compose(experiment())).ticks)


def test_a_run_gives_the_readings_as_an_array() -> None:
    """Arrays and columns of a run have them under the name of what they are; other runs have no such column."""
    run = sr.run("liu2023/fig08", {"duration": 1.0} | IDEAL)
    readings = run.arrays.base.wheel_momentum
    assert readings is not None
    assert readings.shape == (5, 3)
    assert dict(run.arrays.columns())["base.wheel_momentum.z"].tolist() == readings[:, 2].tolist()
    other = sr.run("liu2023/fig08", {"duration": 1.0}).arrays
    assert other.base.wheel_momentum is None
    assert not [name for name, _ in other.columns() if name.startswith("base.wheel")]


def test_the_page_shows_the_reading() -> None:
    """A plot of its own beside that of the truth, only where it is measured."""
    pytest.importorskip("plotly")
    from space_robot_report.pages.log_plots import effort_plots

    for keys, count in ((IDEAL, 1), ({}, 0)):
        composition = compose(experiment(**keys))
        arrays = arrays_of(run_in_memory(composition).ticks)
        plots = effort_plots(arrays, composition.joint_names, composition.nominal)
        assert len([plot for plot in plots if "as measured" in plot.title]) == count


@pytest.mark.parametrize("name", ["giordano2023/sec5", "song2023/pccs"])
def test_a_robot_without_wheels_has_nothing_to_measure(space_robot: Tool, name: str) -> None:
    """One line that names the key, exit code 2, for a free-flying robot and for one with a grasp."""
    key = "plant.sensors.wheel_momentum"
    refused(space_robot("run", name, "--set", f"{key}={{}}", "--out", "run"), f"{key}: the robot has no wheels")


def test_a_monitor_reads_what_was_measured() -> None:
    """A supervisor that watches the wheels sees the reading, not what the commands add up to."""
    table = {"modes": {"NOMINAL": {}}, "monitors": [{"name": "full", "value": "wheels.momentum", "above": 1.5}]}
    biased = {"plant.sensors.wheel_momentum": {"bias": [0.0, 0.0, 1.6]}}
    for keys, expected in (({}, []), (biased, ["full"])):
        ticks = run_in_memory(compose(experiment(supervision=table, **keys))).ticks
        assert [event.name for tick in ticks for event in tick.diagnostics][:1] == expected
