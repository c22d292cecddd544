"""Runs in one compiled call against the loop: the same bits, whatever is run."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.judge.judging import judge_memory
from space_robot_bringup.modes import headless
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.hooks import Hooks
from space_robot_control.laws.base import Blocks
from space_robot_control.laws.computed_torque.law import ComputedTorque
from space_robot_description.kernel import jit
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_msgs_py.log.writer import MemorySink
from tests.support.paths import ROOT

pytestmark = pytest.mark.skipif(not jit.MACHINE_CODE, reason="without a compiler every run is the loop")
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
    {"law": "damped_hold", "gains": {"rate": 0.3}},
    {"law": "detumble"},
    {"law": "park", "gains": {"posture": {"joint2": 0.3}}},
]


def case(seed: int) -> Composition:
    """A random experiment."""
    rng = np.random.default_rng(seed)
    robot, delays = ("mini", "servicer")[int(rng.integers(2))], [int(one) for one in rng.integers(0, 2, 2)]
    angles, large = rng.uniform(-20.0, 20.0, 3).tolist(), bool(rng.integers(2))
    data = {
        "robot": robot,
        "control_period": 0.25,
        "duration": 0.25 * (TICKS - 1),
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


@pytest.mark.parametrize("seed", range(2 * len(LAWS)))
def test_a_compiled_run_has_the_bits_of_the_loop(seed: int) -> None:
    """Law, sensors, delays, wheels, capture, saturation: every number of every tick, and the verdict, are the same."""
    composition = case(seed)
    fused, sink = compiled_run(composition), looped(composition)
    if sink.end_reason != "completed":
        assert fused is None
        return
    assert fused is not None
    assert different(fused.arrays, sink.arrays) == []
    assert str(judge_memory(fused, composition)) == str(judge_memory(sink, composition))
    assert different(_of_ticks(fused.ticks), sink.arrays) == []


def _of_ticks(ticks: Any) -> LogArrays:
    sink = MemorySink()
    sink.ticks = ticks
    return sink.arrays


def test_a_run_that_fails_is_run_by_the_loop() -> None:
    """A compiled run that cannot go on gives way to the loop, which says what failed and when."""
    composition = compose(
        load_experiment("liu2023/fig08", ["initial.attitude_deg=[0, 89.9, 0]", "initial.angular_velocity=[0, 1.0, 0]"])
    )
    assert compiled_run(composition) is None
    sink = run_in_memory(composition)
    assert isinstance(sink, MemorySink)
    assert "singularity of Euler angles" in (sink.end_reason or "")


@pytest.mark.parametrize(
    "changes",
    [
        ["controller={law: mfac, gains: {initial: {source: pulses, seconds: 1.0}}}"],
        ["controller={law: mfac, gains: {adjust: true}}"],
        ["controller.gains={update: rls, consistency: project}"],
        ["plant.integrator.kernel=pinocchio"],
        ["plant.monitor={limit: {factor: 1e-6, response: clip}}"],
        ["plant.monitor={rate: {factor: 1e-9, response: refuse}}"],
        ["supervision=mini_basic"],
        ["plant.sensors.wheel_momentum={}"],
    ],
)
def test_what_is_not_compiled_is_run_by_the_loop(changes: list[str]) -> None:
    """A law, a plant or a supervision without a compiled form has no compiled run, and no error."""
    assert compiled_run(compose(load_experiment("liu2023/fig08", [*changes, "duration=1.0"]))) is None


@pytest.mark.parametrize(
    "changes", [["plant.monitor={limit: {factor: 100.0}}"], ["plant.monitor={rate: {factor: 1e3}}"]]
)
def test_what_changes_no_command_keeps_a_run_compiled(changes: list[str]) -> None:
    """A monitor that lets every command pass, and brakes that never close, have the bits of the loop."""
    brakes = ["plant.hold={last_for: 3, brakes: true}", "duration=3.0"]
    composition = compose(load_experiment("liu2023/fig08", [*changes, *brakes]))
    fused, sink = compiled_run(composition), looped(composition)
    assert fused is not None
    assert different(fused.arrays, sink.arrays) == []
    assert [tick.sample.events for tick in fused.ticks] == [tick.sample.events for tick in sink.ticks]


class Louder(ComputedTorque):
    """Another law by its ``compute``."""

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        u, blocks = super().compute(state, reference)
        return 2.0 * u, blocks


class Alike(ComputedTorque):
    """The same law by another name."""


@pytest.mark.parametrize(("kind", "compiled"), [(Louder, False), (Alike, True)])
def test_a_subclass_with_its_own_text_is_run_by_the_loop(
    kind: type[ComputedTorque], compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The compiled form of a law is not taken for a subclass that computes something else."""
    composition = compose(load_experiment("compare/mini", ["duration=1.0"]))
    law = kind(composition.nominal, composition.experiment.control_period)
    monkeypatch.setattr(Composition, "controller", lambda self: law)
    assert (compiled_run(composition) is not None) == compiled


def test_the_example_of_a_compiled_law_has_the_bits_of_the_loop() -> None:
    """The law of ``examples/compiled_law.py``, found by its path."""
    law = f"controller={{law: '{ROOT / 'examples' / 'compiled_law.py'}:Springs', gains: {{}}}}"
    composition = compose(load_experiment("liu2023/fig08", [law, "expect={}", "duration=3.0"]))
    fused, sink = compiled_run(composition), looped(composition)
    assert fused is not None
    assert different(fused.arrays, sink.arrays) == []
    assert np.abs(fused.arrays.effort_command).max() > 0.0


def test_hooks_see_every_tick() -> None:
    """With hooks a run is the loop, which tells of its ticks while it runs."""
    composition, seen = compose(load_experiment("compare/mini", ["duration=1.0"])), list[int]()
    headless.run_in_memory(composition, Hooks(on_tick=seen.append))
    assert seen == [0, 1, 2, 3, 4]
