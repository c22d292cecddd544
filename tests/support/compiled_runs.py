"""Random runs of every compiled law, what the loop makes of them, and how runs are compared bit by bit."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.hooks import Hooks
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_msgs_py.log.writer import MemorySink

TICKS = 40
NOISY: dict[str, Any] = {
    "position": {"noise": 1e-3, "delay": 0.5, "quantisation": 1e-4},
    "attitude": {"noise": 1e-3, "bias": 1e-4},
    "angular_velocity": {"noise": 1e-4, "delay": 0.25},
    "joint_position": {"quantisation": 1e-4},
    "acceleration": {"noise": 1e-3},
}
LAWS: list[dict[str, Any]] = [
    {"law": "computed_torque", "gains": {"bandwidth": 0.3}},
    {"law": "ntsmc"},
    {"law": "ntsmc", "gains": {"clamp": True, "saturation": "direction_preserving", "gamma": {"joints": 0.3}}},
    {"law": "ntsmc", "gains": {"adaptation": {"leak": 0.1, "cap": 0.01, "freeze_on_saturation": True}}},
    {"law": "ntsmc_euler", "gains": {"start_deg": [-350, 0, 0]}},
    {"law": "ntsmc_euler", "gains": {"angles": "wrapped", "clamp": True}},
    {"law": "adaptive", "gains": {"update": "none", "lambda_on": "velocity"}},
    {"law": "adaptive", "gains": {"update": "rls", "lead": True, "rls": {"translation": "accelerometer"}}},
    {"law": "adaptive", "gains": {"update": "rls_filtered", "rls": {"reset": {"threshold": 1e-3, "samples": 2}}}},
    {"law": "adaptive", "gains": {"update": "lyapunov", "gyroscopic": False}},
    {"law": "adaptive", "gains": {"update": "composite"}},
    {"law": "mfac", "gains": {"estimator": {"sigma": 0.9, "beta": 1e-3}}},
    {"law": "mfac", "gains": {"form": "position", "rho": 0.01, "kappa": 60.0, "filter": {}, "output_order": 3}},
    {"law": "mfac", "gains": {"input_order": 3, "units": "printed", "control_weight": 1e-9, "lead": 4.0}},
    {"law": "pd", "gains": {"bandwidth": 0.2}},
    {"law": "pd", "gains": {"bandwidth": 0.2, "outputs": ["yaw", "joint2"], "held": ["joint1"], "filter": {}}},
    {"law": "reaction_null_space", "gains": {"weight": 0.1}},
    {"law": "lqr", "gains": {"posture_step": 0.05}},
    {"law": "mpc", "gains": {"horizon": 4, "base_error": 1.0, "joint_error": 2.0}},
    {"law": "damped_hold", "gains": {"rate": 0.3}},
    {"law": "detumble"},
    {"law": "park", "gains": {"posture": {"joint2": 0.3}}},
]


def case(seed: int, ticks: int = TICKS) -> Composition:
    """A random experiment."""
    rng = np.random.default_rng(seed)
    robot, delays = ("mini", "servicer")[int(rng.integers(2))], [int(one) for one in rng.integers(0, 2, 2)]
    angles, large = rng.uniform(-20.0, 20.0, 3).tolist(), bool(rng.integers(2))
    data = {
        "robot": robot,
        "control_period": 0.25,
        "duration": 0.25 * (ticks - 1),
        "seed": seed,
        "initial": {"attitude_deg": angles, "angular_velocity": (0.01 * rng.normal(size=3)).tolist()},
        "reference": [
            {"kind": "hold", "attitude_deg": [0, 0, 0]},
            {"kind": "quintic", "duration": 5.0, "attitude_deg": [10, 0, 5], "joints_by_deg": 60 if large else 5},
            {"kind": "step", "attitude_deg": [50 if large else 5, 0, 0], "time": 2.0},
        ][int(rng.integers(3))],
        "controller": LAWS[seed % len(LAWS)],
        "plant": {
            "sensors": NOISY if rng.integers(2) else {},
            "delay_periods": delays[0],
            "payload": {"mass": 2.0, "inertia": [0.1, 0.1, 0.1], "com": [0.0, 0.0, 0.05]},
            "dispersion": {"eta": 0.05},
        },
        "nominal": {"delay_periods": delays[1]},
    }
    if seed % 5 == 0:
        body = {"mass": 3.0, "inertia": [0.05, 0.05, 0.05], "com": [0.0, 0.0, 0.1]}
        data["plant"]["capture"] = {"time": 4.0, "payload": body, "angular_velocity": [0.05, 0.0, 0.1]}  # type: ignore[index]
        del data["plant"]["payload"]  # type: ignore[attr-defined]
    return compose(Experiment.model_validate(data))


def looped(composition: Composition) -> MemorySink:
    """The same run by the loop."""
    sink = run_in_memory(composition, Hooks())
    assert isinstance(sink, MemorySink)
    return sink


def compiles(sink: MemorySink) -> bool:
    """Whether a run has a compiled one: it completes, and no tick takes a solver."""
    return sink.end_reason == "completed" and not sink.arrays.controller.get("limited", np.zeros(1)).any()


def different(first: LogArrays, second: LogArrays) -> list[str]:
    """Names of what differs in a bit, and whether the layout does."""
    found = []
    for field in fields(LogArrays):
        a, b = getattr(first, field.name), getattr(second, field.name)
        if a is None and b is None:
            # What neither run measures.
            continue
        pairs = zip(a.items(), b.items(), strict=True) if isinstance(a, dict) else [(("", a), ("", b))]
        for (label, x), (other, y) in pairs:
            if label != other or x.shape != y.shape or x.tobytes() != y.tobytes():
                found.append(f"{field.name} {label}")
    return found
