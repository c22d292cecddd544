"""Headless closed loop: what a control period costs, and who takes it; tick by tick, and in one compiled call."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter, process_time

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes import headless
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.hooks import Hooks
from space_robot_msgs_py.log.writer import LogSink, MemorySink

CASES = ("liu2023/fig08", "point_to_point/panda_sat")
PERIODS, REPEATS = 1500, 5
# Of these the parts are compiled.
FUSED = {
    "ntsmc, servicer": ("giordano2023/sec5", ()),
    "ntsmc_euler, servicer": ("giordano2023/sec5_euler", ()),
    "adaptive, mini, noisy": ("liu2023/fig08", ("plant.sensors.attitude.noise=1e-4", "plant.delay_periods=1")),
    "adaptive with rls, mini": ("liu2023/fig08", ("controller.gains.update=rls",)),
    "computed_torque, servicer": ("compare/servicer", ()),
}


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
    return table | _fused()


def _fused() -> dict[str, float]:
    """CPU microseconds per period of whole runs, making of parts and references included; the least of five turns."""
    table: dict[str, float] = {}
    for name, (case, changes) in FUSED.items():
        experiment = load_experiment(case, changes)
        composition = compose(with_duration(experiment, PERIODS * experiment.period / 1e9))
        least = {"loop": float("inf"), "one call": float("inf")}
        for _ in range(REPEATS):
            for way, hooks in (("loop", Hooks()), ("one call", None)):
                begin = process_time()
                sink = run_in_memory(composition, hooks)
                least[way] = min(least[way], process_time() - begin)
                assert sink.end_reason == "completed"
        for way, seconds in least.items():
            table[f"{name}, {way}: CPU us per period"] = 1e6 * seconds / PERIODS
        table[f"{name}: loop over one call"] = least["loop"] / least["one call"]
    return table
