"""Model-free control and PD on the air-bearing testbed: the four cases, distorted samples, and what never counts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_control.gated_filter import GatedFilter
from space_robot_control.laws.mfac.incremental_controller import IncrementalController, weights_of
from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import Command, RobotState, Telemetry, Tick
from tests.support.whole_metrics import measure

CASES = ("attitude_6_85", "attitude_1_7", "position_1036", "position_874")


def simulate(
    name: str, *overrides: str, sees: Callable[[int, RobotState], RobotState] = lambda k, state: state
) -> tuple[RunMetrics, Telemetry]:
    """Run a shipped experiment without a log; ``sees`` stands between sensors and law."""
    experiment = load_experiment(f"song2023/{name}", overrides)
    parts = compose(experiment)
    plant, law, reference = parts.plant(), parts.controller(), parts.reference()
    sample, ticks = plant.reset(), []
    for k in range(experiment.steps + 1):
        asked = reference.at(sample.state.stamp)
        output = law.update(sees(k, sample.state), asked)
        ticks.append(Tick(sample, asked, output))
        sample = plant.step(output.command)
    metrics = measure(
        ticks,
        parts.joint_names,
        base_translation=True,
        prismatic=parts.nominal.prismatic,
        bands=experiment.settling_bands,
    )
    return metrics, output.telemetry


def settling(metrics: RunMetrics, axis: str) -> float | None:
    return metrics.flat()[f"{axis}.settling_time"]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("suffix", ["", "_pd"])
def test_the_four_cases_settle(case: str, suffix: str) -> None:
    """With the documented settings model-free control and PD reach 0.2 deg or 10 mm and stay, on a fresh seed."""
    metrics, _ = simulate(case + suffix, "seed=101", "duration=100.0")
    time = settling(metrics, "base/yaw" if case.startswith("attitude") else "base/x")
    assert time is not None
    assert time < 75.0
    assert metrics.energy_residual < 1e-7
    assert metrics.momentum_residual < 1e-8


@pytest.mark.slow
def test_a_frozen_sensor_and_five_percent_outliers_are_survived() -> None:
    """Readings that stand still for three seconds, and one in twenty far off: the attitude settles all the same."""
    last: list[RobotState] = []

    def stuck(k: int, state: RobotState) -> RobotState:
        if 80 <= k < 110:
            held = last[0]
            return RobotState(state.stamp, held.q, held.v, held.effort, held.base_acceleration)
        last[:] = [state]
        return state

    metrics, telemetry = simulate("attitude_6_85", "plant.camera.outlier_share=0.05", sees=stuck)
    assert settling(metrics, "base/yaw") is not None
    assert metrics.flat()["base/yaw.final_error"] < 0.2  # type: ignore[operator]
    assert telemetry["gate_count"][0] > 20


def core_run(spoil: Callable[[int, float], float]) -> float:
    """Largest |angle| [rad] of the last ten seconds of filter and core law on a rigid testbed, samples spoilt."""
    inertia, period, lead = 160.6, 0.1, 8.0
    measured = GatedFilter(period, 3.0, np.array([np.radians(0.5)]), 20)
    phi = period * (lead + 0.5 * period) / inertia
    gradient = PseudoGradient(np.array([[1.0, 0.0, phi]]), 2, 1, sigma=0.0, beta=1.0)
    law = IncrementalController(weights_of(2, 1, 0.02, 10.0, 0.0), 2, 1, np.array([0.1]))
    rng, angle, rate, before, late = np.random.default_rng(8), np.radians(6.85), 0.0, np.zeros(1), []
    for k in range(1200):
        measured.update(np.array([spoil(k, angle + 3.5e-4 * rng.normal())]))
        out = measured.value + lead * measured.rate
        torque = float(law.update(-out, out - before, gradient)[0])
        before = out
        angle, rate = angle + period * rate + 0.5 * period**2 * torque / inertia, rate + period * torque / inertia
        late = [*late[-99:], abs(angle)]
    return max(late)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e9])
def test_a_non_finite_sample_does_not_make_the_estimator_diverge(bad: float) -> None:
    """One sample in ten not finite or absurd, and the angle still ends within 0.2 degrees."""
    assert core_run(lambda k, y: bad if k % 10 == 7 else y) < np.radians(0.2)


def test_a_run_that_is_not_finite_never_counts_as_settled() -> None:
    """A tick with NaN cannot be made, so neither can a metric from it."""
    with pytest.raises(NonFiniteError):
        Command(0, np.array([np.nan] * 6), np.zeros(3))


STIFF = "plant.grasp={stiffness: 1.0e5, damping: 1.0e3, torsional_stiffness: 4.0e4, slip_torque: 100.0}"


@pytest.mark.slow
def test_five_seconds_of_push_identify_the_inertia_of_a_stiff_pair() -> None:
    """Held firmly, the pair's inertia comes out of five seconds of camera samples to about ten percent, as stated."""
    _, telemetry = simulate(
        "initial_online",
        "duration=6.0",
        "controller.gains.initial={source: push, seconds: 5.0, level: 1.0}",
        "plant.step=0.002",
        STIFF,
    )
    assert 0.03 < telemetry["initial_deviation"][0] < 0.25
    assert telemetry["initial_gain"][0] == pytest.approx(1.0 / 160.6, rel=0.25)


def test_a_slipping_grasp_shows_a_lighter_body() -> None:
    """At full torque the grasp slips and five seconds show the servicer more than the pair: the gain is too large."""
    _, telemetry = simulate(
        "initial_online", "duration=6.0", "controller.gains.initial={source: push, seconds: 5.0, level: 1.0}"
    )
    assert telemetry["initial_gain"][0] > 2.0 / 160.6


def test_the_baseline_stands_beside_every_case() -> None:
    """Every shipped model-free case of the testbed has its PD beside it."""
    from space_robot_description.share import shipped

    names = set(shipped("experiments"))
    for case in CASES:
        assert {f"song2023/{case}", f"song2023/{case}_printed", f"song2023/{case}_pd"} <= names


def test_a_run_is_a_function_of_its_seed() -> None:
    """The same experiment and seed give the same bits."""
    first: Any
    first, again = (simulate("attitude_6_85", "duration=5.0")[1].data.tobytes() for _ in range(2))
    assert first == again
