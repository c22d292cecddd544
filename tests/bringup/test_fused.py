"""Runs in one compiled call against the loop: the same bits, whatever is run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
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
from tests.support.compiled_runs import LAWS, case, compiles, different, looped
from tests.support.paths import ROOT

pytestmark = pytest.mark.skipif(not jit.MACHINE_CODE, reason="without a compiler every run is the loop")


@pytest.mark.parametrize("seed", range(2 * len(LAWS)))
def test_a_compiled_run_has_the_bits_of_the_loop(seed: int) -> None:
    """Law, sensors, delays, wheels, capture, saturation: every number of every tick, and the verdict, are the same."""
    composition = case(seed)
    fused, sink = compiled_run(composition), looped(composition)
    if not compiles(sink):
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
        ["controller={law: mpc, gains: {base_error: 0.001}}", "initial.attitude_deg=[60, 0, 0]"],
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
