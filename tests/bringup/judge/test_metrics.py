"""Metrics say what happened, from known motions; a number that is not finite never counts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from space_robot_bringup.experiment.expectations import Expectation
from space_robot_bringup.judge.metrics import RunMetrics, deviations, metric_names
from space_robot_bringup.judge.verdict import check_expectations, judge
from space_robot_description.rotations import exp, log, relative
from space_robot_msgs_py.errors import NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import (
    Command,
    ControlOutput,
    PlantSample,
    Reference,
    RobotState,
    Telemetry,
    Tick,
    Vector,
)
from tests.support.whole_metrics import measure

PERIOD = 100_000_000


def tick(k: int, roll: float, joint: float, goal: tuple[float, float], moving: bool = False) -> Tick:
    """One tick of a robot with one joint: true roll and joint angle, and where they should be [rad]."""
    truth = np.concatenate([np.zeros(3), exp([roll, 0.0, 0.0]), [joint]])
    wanted = np.concatenate([np.zeros(3), exp([goal[0], 0.0, 0.0]), [goal[1]]])
    blocks = {
        "true_configuration": truth,
        "applied_wrench": [0, 0, 0, 1.0, 0, 0],
        "applied_effort": [-2.0],
        "saturation": np.full(7, float(k % 4 == 1)),
        "momentum_residual": [1e-12, 1e-13],
        "energy_residual": 1e-11,
        "quaternion_residual": 0.0,
        "joint_limit": 0.0,
    }
    stamp = k * PERIOD
    state = RobotState(stamp, truth, np.zeros(7), np.zeros(1), np.zeros(3))
    rate: Vector = np.full(7, float(moving))
    output = ControlOutput(Command(stamp, np.zeros(6), np.zeros(1)), Telemetry.of(stamp, {}))
    return Tick(PlantSample(state, Telemetry.of(stamp, blocks)), Reference(stamp, wanted, rate, np.zeros(7)), output)


def step_response(ticks: int = 101) -> RunMetrics:
    """Roll decays from 0 to 0.2 rad with a time constant of 1 s; the joint swings about 0.5 rad and dies out."""
    rows = []
    for k in range(ticks):
        t = k * 0.1
        roll = 0.2 * (1 - math.exp(-t))
        joint = 0.5 * (1 - math.exp(-t) * math.cos(math.pi * t))
        rows.append(tick(k, roll, joint, (0.2, 0.5)))
    return measure(rows, ["hinge"], base_translation=False)


def test_settling_overshoot_and_errors_of_a_known_step() -> None:
    """First order settles to 2 % at the first sample past ln 50 = 3.91 s; the swing overshoots by its first crest."""
    numbers = step_response().flat()
    assert numbers["base/roll.settling_time"] == pytest.approx(4.0)
    assert numbers["base/roll.overshoot"] == 0.0
    assert numbers["base/roll.final_error"] == pytest.approx(math.degrees(0.2 * math.exp(-10.0)))
    crest = 1.0 - math.atan(1.0 / math.pi) / math.pi
    assert numbers["hinge.overshoot"] == pytest.approx(-100 * math.exp(-crest) * math.cos(math.pi * crest), abs=0.01)
    assert numbers["base/pitch.settling_time"] is None
    assert numbers["saturation_share"] == pytest.approx(0.25)
    assert numbers["effort_integral"] == pytest.approx(3.0 * 10.0)


def test_an_axis_that_is_still_outside_its_band_has_not_settled() -> None:
    """A run that ends too early reports no settling time, not the length of the run."""
    assert step_response(ticks=30).flat()["base/roll.settling_time"] is None


def test_a_reference_that_keeps_moving_has_no_settling_time() -> None:
    """Tracking is judged by its error; settling is not defined."""
    rows = [tick(k, 0.01 * k, 0.0, (0.01 * k, 0.0), moving=True) for k in range(20)]
    numbers = measure(rows, ["hinge"], base_translation=False).flat()
    assert numbers["base/roll.settling_time"] is None
    assert numbers["base/roll.max_error"] == pytest.approx(0.0, abs=1e-9)


def test_a_run_without_ticks_cannot_be_judged() -> None:
    """Nothing run is an error, not a success."""
    with pytest.raises(NonFiniteError):
        measure([], ["hinge"], base_translation=False)


@pytest.mark.parametrize(("error", "passed"), [(None, None), (1e-9, True), (2e-3, False)])
def test_the_verdict_says_the_error_of_the_integration(error: float | None, passed: bool | None) -> None:
    """It fails a trajectory that is off although momentum is kept; a log that does not say has no such check."""
    metrics = replace(step_response(ticks=30), integration_error=error)
    found = [check.passed for check in judge(metrics, {}, "completed") if check.name == "integration_error"]
    assert found == ([] if passed is None else [passed])


@pytest.mark.parametrize(
    ("name", "bound"),
    [
        ("momentum_residual", 1e-8),
        ("energy_residual", 1e-7),
        ("quaternion_residual", 1e-8),
        ("integration_error", 1e-5),
    ],
)
def test_a_plant_that_is_off_by_more_than_its_bound_fails_whatever_is_expected(name: str, bound: float) -> None:
    """At the bound it passes; beyond it, and where the number is none, it does not."""
    for value, passed in ((bound, True), (1.01 * bound, False), (float("nan"), False)):
        checks = judge(replace(step_response(ticks=30), **{name: value}), {}, "completed")
        assert [check.passed for check in checks if check.name == name] == [passed], value


def test_the_verdict_fails_what_is_missing_or_out_of_bounds() -> None:
    """A bound on a number the run does not have fails; an unknown metric is refused with the nearest name."""
    metrics = step_response(ticks=30)
    checks = judge(metrics, {"base/roll.settling_time": Expectation(max=10.0)}, "completed")
    assert [check.name for check in checks if not check.passed] == ["base/roll.settling_time"]
    assert not judge(metrics, {}, "interrupted")[0].passed
    names = metric_names(["hinge"], base_translation=False)
    assert names == list(metrics.flat())
    with pytest.raises(SpecError, match=r"base/roll\.final_error"):
        check_expectations({"base/rol.final_error": Expectation(max=1.0)}, names)


def test_deviations_are_rotation_vectors_the_short_way() -> None:
    """For random pairs, equal ones and both signs of one attitude: what ``rotations`` says of each pair, to 1e-14."""
    goals, actual = np.random.default_rng(0).normal(size=(2, 200, 4))
    actual[0], actual[1] = goals[0], -goals[1]
    q_d, q = (np.zeros((200, 7)) for _ in range(2))
    q_d[:, 3:], q[:, 3:] = (a / np.linalg.norm(a, axis=1, keepdims=True) for a in (goals, actual))
    expected = [log(relative(g[3:], a[3:])) for g, a in zip(q_d, q, strict=True)]
    np.testing.assert_allclose(deviations(q, q_d)[:, 3:6], expected, rtol=0, atol=1e-14)
