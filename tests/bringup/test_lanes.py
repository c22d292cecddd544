"""Runs side by side in one compiled call: each has the bits that it has alone, whatever its neighbours do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.experiment import experiment_from, load_experiment
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.fused.sink import FusedRun
from space_robot_description.kernel import jit
from space_robot_description.kernel.lanes import LANES
from space_robot_description.load import load_robot
from space_robot_sim.kernel import lanes as kernel
from tests.support.compiled_runs import LAWS, case, compiles, different, looped

pytestmark = pytest.mark.skipif(not jit.MACHINE_CODE, reason="without a compiler every run is the loop")

if jit.MACHINE_CODE:
    from space_robot_bringup.fused import lanes
    from space_robot_bringup.fused.lanes import compiled_runs


@pytest.fixture
def groups(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the groups that share a call."""
    seen: list[int] = []
    completed = lanes._Group.completed

    def counted(group: Any) -> Any:
        seen.append(len(group._runs))
        return completed(group)

    monkeypatch.setattr(lanes._Group, "completed", counted)
    return seen


def same(run: FusedRun | None, composition: Composition) -> None:
    """The run has the bits of the same run alone, compiled and by the loop."""
    alone, sink = compiled_run(composition), looped(composition)
    if not compiles(sink):
        assert run is None
        assert alone is None
        return
    assert run is not None
    assert alone is not None
    assert different(run.arrays, alone.arrays) == []
    assert different(run.arrays, sink.arrays) == []


@pytest.mark.parametrize("law", range(len(LAWS)))
def test_a_lane_has_the_bits_of_the_run_alone_and_of_the_loop(law: int, groups: list[int]) -> None:
    """Of every law: robots, starts, delays, sensors, payloads and captures that differ change no bit of a neighbour."""
    compositions = [case(law + k * len(LAWS)) for k in range(2 * LANES + 1)]
    for run, composition in zip(compiled_runs(compositions), compositions, strict=True):
        same(run, composition)
    assert groups


def test_a_run_that_fails_disturbs_no_other(groups: list[int]) -> None:
    """One lane meets a singularity and has no result; those beside it have all bits of theirs."""
    wild = ["initial.attitude_deg=[0, 89.9, 0]", "initial.angular_velocity=[0, 1.0, 0]"]
    calm = [[f"initial.attitude_deg=[0, {k}, 0]"] for k in range(2)]
    changes = [calm[0], wild, calm[1]][:LANES]
    compositions = [compose(load_experiment("liu2023/fig08", [*one, "duration=20.0"])) for one in changes]
    runs = compiled_runs(compositions)
    assert [run is None for run in runs] == [False, True, False][:LANES]
    for run, composition in zip(runs, compositions, strict=True):
        same(run, composition)
    assert groups == [min(3, LANES)]


@pytest.mark.parametrize(
    ("name", "robot", "changes"),
    [
        ("point_to_point/disturbed", {}, []),
        ("point_to_point/panda_gripper", {}, []),
        ("liu2023/fig08", {"base_torque.torque": 0.05, "base_torque.momentum": 0.1}, ["duration=20.0"]),
        ("giordano2023/sec5", {"base_force": {"kind": "thrusters", "limit": [9, 9, 9], "pwm": True}}, []),
        ("giordano2023/sec5", {}, ["plant.integrator.rtol=1e-12", "control_period=1.0"]),
        ("liu2023/fig08", {"joints.lag": 0.05}, []),
        ("liu2023/fig08", {}, ["plant.integrator={kind: rk4}"]),
    ],
)
def test_what_acts_on_a_robot_has_the_same_bits_in_lanes(
    name: str, robot: dict[str, Any], changes: list[str], groups: list[int]
) -> None:
    """Disturbances, joints that follow others, full wheels, pulses, steps that miss a tolerance, lag, other steps."""
    compositions = []
    for k in range(LANES):
        start = [f"initial.attitude_deg=[{4 * k}, {k}, {-3 * k}]", "duration=10.0", *changes]
        data = load_experiment(name, start).model_dump(mode="json")
        data["robot"] = dict(load_robot(data["robot"]).resolved)
        for key, value in robot.items():
            set_key(data, f"robot.actuators.{key}", value, "robot")
        compositions.append(compose(experiment_from(data, name)))
    for run, composition in zip(compiled_runs(compositions), compositions, strict=True):
        same(run, composition)
    # Adaptive steps and others than the default ones are not those of the neighbours.
    assert groups == ([] if "joints.lag" in robot or "kind: rk4" in str(changes) else [LANES])


def test_lanes_beside_each_other_are_lanes() -> None:
    """An array of lanes is aligned, and as many as the registers of this processor hold make one row."""
    array = kernel.empty(LANES, 3, 2)
    assert array.shape == (3, 2, LANES)
    assert array.ctypes.data % 64 == 0
    assert not np.any(array)
