"""Logs of any length, quickly: a short run whose ticks come again and again at later stamps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_msgs_py.interfaces import NANOSECONDS, ControlOutput, PlantSample, Tick
from space_robot_msgs_py.log.writer import LogSink

EXPERIMENT = "liu2023/fig08"
SHORT = "duration=20.0"
OVERRIDES = ("control_period=0.1", "expect={}")


def write_long_log(directory: Path, count: int) -> Composition:
    """A closed log of ``count`` ticks, which says of itself that it is the whole run.

    Args:
        directory: of the run.
        count: ticks.

    Returns:
        What its experiment composes to.
    """
    ticks = run_in_memory(compose(load_experiment(EXPERIMENT, (*OVERRIDES, SHORT)))).ticks
    period = ticks[1].stamp
    duration = f"duration={(count - 1) * period / NANOSECONDS!r}"
    composition = compose(load_experiment(EXPERIMENT, (*OVERRIDES, duration)))
    sink = LogSink(directory, composition.header, custom={"mode": "headless"})
    for index in range(count):
        sink.record(moved(ticks[index % len(ticks)], index * period))
    sink.close("completed")
    return composition


def moved(tick: Tick, stamp: int) -> Tick:
    """The same tick at another stamp [ns]."""
    sample, output = tick.sample, tick.output
    return Tick(
        PlantSample(replace(sample.state, stamp=stamp), replace(sample.telemetry, stamp=stamp)),
        replace(tick.reference, stamp=stamp),
        ControlOutput(replace(output.command, stamp=stamp), replace(output.telemetry, stamp=stamp)),
    )
