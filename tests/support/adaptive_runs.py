"""Runs of the robot mini under the adaptive law, and what their telemetry says."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.modes import headless
from space_robot_msgs_py.interfaces import Tick, Vector
from space_robot_msgs_py.log.writer import MemorySink

WAVES = {
    "kind": "harmonic",
    "roll": {"amplitude_deg": 10, "frequency": 0.05},
    "joints": [(), *({"amplitude_deg": 10, "frequency": 0.05},) * 3],
}
PRIOR = {"dispersion": {"eta": 0.2, "inconsistent": "keep"}}


def simulate(gains: dict[str, Any], **changes: Any) -> tuple[Composition, list[Tick], str]:
    """Run `mini` through the waves of Fig. 11 under the adaptive law, with changes to the experiment."""
    experiment = {
        "robot": "mini",
        "control_period": 0.25,
        "duration": 60.0,
        "seed": 1,
        "initial": {"joints_deg": [90, 45, 45, 0]},
        "reference": WAVES,
        "controller": {"law": "adaptive", "gains": gains},
    }
    composition, sink = compose(experiment_from(experiment | changes, "test")), MemorySink()
    parts = composition.plant(), composition.controller(), composition.reference()
    reason = headless.run(*parts, steps=composition.experiment.steps, sink=sink)
    return composition, sink.ticks, reason


def block(ticks: list[Tick], label: str) -> Vector:
    """One telemetry block over time."""
    return np.array([tick.output.telemetry[label] for tick in ticks])


def rms(ticks: list[Tick], start: float = 0.0) -> float:
    """Root mean square of all errors from a time on [rad]."""
    late = [tick for tick in ticks if tick.stamp >= 1e9 * start]
    return float(np.sqrt(np.mean(np.hstack([block(late, "euler_error"), block(late, "joint_error")]) ** 2)))
