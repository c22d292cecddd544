"""Headless closed loop: what a control period costs, in memory and logged."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes import headless
from space_robot_msgs_py.log.writer import LogSink, MemorySink

CASES = ("liu2023/fig08", "point_to_point/panda_sat")
PERIODS = 1500


def run() -> dict[str, float]:
    """Microseconds per control period and simulated seconds per second, in memory and logged."""
    table: dict[str, float] = {}
    for case in CASES:
        experiment = load_experiment(case)
        experiment = with_duration(experiment, PERIODS * experiment.period / 1e9)
        composition = compose(experiment)
        with tempfile.TemporaryDirectory() as scratch:
            for name, sink in (
                ("in memory", MemorySink()),
                ("logged", LogSink(Path(scratch) / "run", composition.header)),
            ):
                parts = composition.plant(), composition.controller(), composition.reference()
                parts[0].step(None)
                begin = perf_counter()
                headless.run(*parts, steps=PERIODS, sink=sink)
                wall = perf_counter() - begin
                table[f"{case}, {name}: us per period"] = 1e6 * wall / PERIODS
                table[f"{case}, {name}: simulated s per s"] = experiment.duration / wall
    return table
