"""What the adaptive law learns of the robot: what is excited, under noise too, and nothing it cannot trust."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition
from space_robot_description.inertia import inertial_parameters
from space_robot_msgs_py.interfaces import Tick, Vector
from tests.support.adaptive_runs import PRIOR, block, rms, simulate

ALL_AXES = {
    "kind": "harmonic",
    **{name: {"amplitude_deg": 8, "frequency": 0.01 * k} for k, name in enumerate(("roll", "pitch", "yaw"), 3)},
    "joints": [{"amplitude_deg": 10, "frequency": 0.01 * k} for k in range(5, 9)],
}


def distance(composition: Composition, ticks: list[Tick]) -> Vector:
    """(1+n, 10) relative error of the last estimate."""
    truth = inertial_parameters(composition.truth)
    return (ticks[-1].output.telemetry["parameters"].reshape(truth.shape) - truth) / np.abs(truth).max(1)[:, None]


@pytest.mark.parametrize("update", ["rls", "rls_filtered", "composite"])
def test_excited_directions_are_found_and_the_others_left_alone(update: str) -> None:
    """With base roll and three joints moving, Ixx of the base is corrected, Iyy and Izz keep the error of the prior."""
    composition, ticks, _ = simulate({"update": update, "lead": True}, nominal=PRIOR, duration=100.0)
    before = inertial_parameters(composition.nominal)[0] / inertial_parameters(composition.truth)[0] - 1.0
    after = ticks[-1].output.telemetry["parameters"][:10] / inertial_parameters(composition.truth)[0] - 1.0
    assert abs(before[4]) > 0.15
    assert abs(after[4]) < 0.01
    assert after[[6, 9]] == pytest.approx(before[[6, 9]], abs=0.002)


def test_exciting_all_axes_recovers_all_inertias_of_the_base() -> None:
    """With every degree of freedom moving, Ixx, Iyy and Izz of the base converge to the truth within 1 %."""
    composition, ticks, _ = simulate({"lead": True}, reference=ALL_AXES, nominal=PRIOR, duration=120.0)
    assert np.abs(distance(composition, ticks)[0, [4, 6, 9]]).max() < 0.01


@pytest.mark.parametrize("seed", [1, 2])
def test_filtered_least_squares_keep_the_ranking_under_gyro_noise(seed: int) -> None:
    """Fig. 13 at eta = 40 % with 1e-3 rad/s of noise: better than Lyapunov's update, and ten times as good as RLS."""
    noisy = {"sensors": {"angular_velocity": {"noise": 1e-3}}}
    prior = {"dispersion": {"eta": 0.4, "inconsistent": "keep"}}
    errors = {}
    for update in ("rls", "rls_filtered", "lyapunov"):
        _, ticks, _ = simulate({"update": update, "lead": True}, plant=noisy, nominal=prior, seed=seed, duration=100.0)
        errors[update] = rms(ticks, 60.0)
    assert errors["rls_filtered"] < errors["lyapunov"]
    assert 10.0 * errors["rls_filtered"] < errors["rls"]


def test_the_filter_takes_the_bias_of_the_noise_from_the_estimate() -> None:
    """With 1e-4 rad/s of noise Ixx of the base stays where it is without: plain RLS is 2 % too large."""
    found = {}
    for update in ("rls", "rls_filtered"):
        for noise in (0.0, 1e-4):
            plant = {"sensors": {"angular_velocity": {"noise": noise}}}
            _, ticks, _ = simulate({"update": update, "lead": True}, plant=plant, nominal=PRIOR, duration=100.0)
            found[update, noise] = ticks[-1].output.telemetry["parameters"][4]
    assert found["rls", 1e-4] / found["rls", 0.0] > 1.015
    assert found["rls_filtered", 1e-4] / found["rls_filtered", 0.0] == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("update", ["rls", "lyapunov", "composite"])
def test_correcting_the_parameters_tracks_better_than_not_to(update: str) -> None:
    """From a prior 20 % off, each update ends with less than a third of the error without one."""
    _, fixed, _ = simulate({"update": "none", "lead": True}, nominal=PRIOR)
    _, learned, reason = simulate({"update": update, "lead": True}, nominal=PRIOR)
    assert reason == "completed"
    assert rms(learned, 30.0) < rms(fixed, 30.0) / 3.0


def test_a_payload_captured_during_the_run_is_learned() -> None:
    """3 kg on a 2 kg antenna at 20 s, no impact: with the reset the error ends below 1/20 of that without update."""
    payload = {"mass": 3.0, "inertia": [0.02, 0.02, 0.03], "pose": {"xyz": [0.0, 0.0, 0.1]}}
    plant = {"capture": {"time": 20.0, "payload": payload, "attached": True}}
    _, fixed, _ = simulate({"update": "none", "lead": True}, plant=plant)
    _, learned, _ = simulate({"update": "rls", "lead": True}, plant=plant)
    assert block(learned, "resets")[-1] == 1.0
    assert block(learned, "resets")[80] == 0.0
    assert rms(learned, 40.0) < rms(fixed, 40.0) / 20.0


def test_a_saturated_base_teaches_nothing() -> None:
    """A period whose torque is beyond the nominal wheels is left out: learned is 0 and the estimate stays."""
    step = {"kind": "step", "attitude_deg": [60, 0, 0]}
    _, ticks, _ = simulate({"update": "rls"}, reference=step, nominal=PRIOR, duration=5.0)
    over = np.abs(np.array([tick.output.command.wrench[3:] for tick in ticks])).max(axis=1) > 1.5
    learned, estimate = block(ticks, "learned")[:, 0], block(ticks, "parameters")
    assert over[0]
    for k in np.flatnonzero(over[:-1]):
        assert learned[k + 1] == 0.0
        assert (estimate[k + 1] == estimate[k]).all()
    assert learned[1:].sum() == np.sum(~over[:-1])


def test_consistency_is_kept_when_it_is_asked_for() -> None:
    """Projection and the natural gradient keep every body possible from a prior that was not; without, it is shown."""
    shares = {}
    for gains in (
        {"update": "rls", "consistency": "none"},
        {"update": "rls", "consistency": "project"},
        {"update": "lyapunov", "consistency": "natural"},
    ):
        _, ticks, reason = simulate(gains | {"lead": True}, nominal=PRIOR)
        assert reason == "completed"
        shares[gains["consistency"]] = block(ticks, "consistent").mean()
    assert shares["none"] < 1.0
    assert shares["project"] == shares["natural"] == 1.0
