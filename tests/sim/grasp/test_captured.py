"""A robot that has captured debris: balance, slip, a shift of the grasp, central gravity, and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.grasp.captured import CapturedDebris
from space_robot_sim.grasp.orbit import Orbit
from space_robot_sim.grasp.spec import CapturedSpec, OrbitSpec
from space_robot_sim.initial import InitialState, RunConditions
from tests.support.nonempty import nonempty

PERIOD = 100_000_000
GRASP = {
    "stiffness": 1e4,
    "damping": 500.0,
    "torsional_stiffness": 4e3,
    "torsional_damping": 100.0,
    "slip_torque": 36.0,
}
CHANGE = {"start": 1.0, "duration": 10.0, "offset": 0.08, "angle_deg": 14.0}


def captured(
    position: tuple[float, ...] = (0, 0, 0), velocity: tuple[float, ...] = (0, 0, 0), period: int = PERIOD, **spec: Any
) -> CapturedDebris:
    q, v = np.array([*position, 0, 0, 0, 1, 0, 0, 0]), np.array([*velocity, 0, 0, 0, 0, 0, 0])
    model = CapturedSpec.model_validate({"grasp": GRASP} | spec)
    return CapturedDebris(load_robot("pccs"), model, RunConditions(period, InitialState(q, v)))


def simulate(plant: CapturedDebris, wrench: tuple[float, ...], periods: int) -> list[PlantSample]:
    command = Command(0, np.array(wrench), np.zeros(3))
    return [plant.reset(), *(plant.step(command) for _ in range(periods))]


def worst(samples: list[PlantSample], label: str) -> float:
    return max(float(sample.telemetry[label].max()) for sample in samples)


@pytest.mark.parametrize("orbit", [None, {"radius": 6.878e6}])
def test_momentum_and_energy_balance(orbit: dict[str, float] | None) -> None:
    """Pushed, turned and shifted, in free space and in orbit, momentum and energy are what was booked."""
    samples = simulate(captured((5.0, -3.0, 1.0), change=CHANGE, orbit=orbit), (20.0, -10.0, 5.0, 4.0, -3.0, 6.0), 200)
    assert worst(samples, "momentum_residual") < 1e-9
    assert worst(samples, "energy_residual") < 1e-8
    assert np.abs(samples[-1].telemetry["true_velocity"]).max() > 0.01


def test_without_a_push_nothing_from_outside_happens() -> None:
    """A shift of the grasp moves the bodies against each other and neither the momentum nor its centre."""
    samples = simulate(captured(change=CHANGE), (0.0,) * 6, 300)
    assert worst(samples, "momentum_residual") < 1e-9
    assert np.abs(samples[-1].telemetry["momentum"]).max() < 1e-6
    np.testing.assert_allclose(samples[-1].state.joints[[0, 2]], [0.08, np.radians(14.0)], rtol=0.05)


def test_the_grasp_slips_only_beyond_its_torque() -> None:
    """A gentle turn leaves the debris where it was held, a hard one about its axis turns it in the grasp."""
    gentle = simulate(captured(), (0, 0, 0, 2.0, 0, 0), 100)[-1].state.joints[2]
    slippery = GRASP | {"torsional_stiffness": 100.0, "torsional_damping": 1.0, "slip_torque": 0.5}
    hard = simulate(captured(grasp=slippery), (0, 0, 0, 20.0, 0, 0), 100)[-1].state.joints[2]
    assert abs(gentle) < 1e-3
    assert abs(hard) > 10.0 * abs(gentle)


@pytest.mark.parametrize("higher", [-2000.0, 0.0, 50.0])
def test_in_orbit_a_free_robot_follows_kepler(higher: float) -> None:
    """Started on another circular orbit it stays there: its place relative to the virtual point is known exactly."""
    spec = OrbitSpec()
    r, n = spec.radius, Orbit(spec).rate
    other, n_other = r + higher, np.sqrt(spec.mu / (r + higher) ** 3)
    loose = {
        "stiffness": 0.0,
        "damping": 0.0,
        "torsional_stiffness": 1e-3,
        "torsional_damping": 0.0,
        "slip_torque": 1.0,
    }
    start, speed = (higher, 0.0, 0.0), (0.0, other * n_other - r * n, 0.0)
    samples = simulate(captured(start, speed, 10_000_000_000, grasp=loose, orbit={}, step=1.0), (0.0,) * 6, 60)
    for k, sample in enumerate(nonempty(samples)):
        t = 10.0 * k
        own, virtual = (size * np.array([np.cos(w * t), np.sin(w * t)]) for size, w in ((other, n_other), (r, n)))
        np.testing.assert_allclose(sample.state.q[:2], own - virtual, rtol=0.0, atol=1e-5)


def test_the_tidal_acceleration_loses_no_digits() -> None:
    """Near the virtual point it is n^2 (2, -1, -1) d, and the difference of the two attractions farther away."""
    orbit = Orbit(OrbitSpec())
    near = np.array(orbit.acceleration(0.0, (1e-3, 2e-3, -1e-3)))
    np.testing.assert_allclose(near / orbit.rate**2, [2e-3, -2e-3, 1e-3], rtol=1e-6)
    far, r, mu = np.array([3e5, -2e5, 1e5]), np.array([6.878e6, 0.0, 0.0]), 3.986004418e14

    def attraction(place: Vector) -> Vector:
        return -mu * place / np.linalg.norm(place) ** 3

    np.testing.assert_allclose(
        orbit.acceleration(0.0, (3e5, -2e5, 1e5)), attraction(r + far) - attraction(r), rtol=1e-9
    )


@pytest.mark.slow
def test_the_attitude_is_kept_while_the_grasp_shifts() -> None:
    """Table 1, row 1: 80 mm and 14 deg during a turn cost the model-free law less than a tenth of a degree."""
    experiment = load_experiment("song2023/pccs", ["duration=60.0"])
    parts = compose(experiment)
    plant, law, reference = parts.plant(), parts.controller(), parts.reference()
    sample, errors = plant.reset(), []
    for _ in range(experiment.steps):
        output = law.update(sample.state, reference.at(sample.state.stamp))
        errors.append(np.abs(output.telemetry["attitude_error"]).max())
        sample = plant.step(output.command)
    assert sample.state.joints[0] == pytest.approx(0.08, abs=2e-3)
    assert np.degrees(max(errors)) < 0.1


def test_what_cannot_be_simulated_is_refused() -> None:
    """A robot without the grasp's joints, one that turns by wheels, a period that does not divide."""
    base = "{law: none}"
    with pytest.raises(SpecError, match=r"plant\.grasp\.joints"):
        compose(load_experiment("song2023/pccs", ["robot=servicer", f"controller={base}"]))
    with pytest.raises(SpecError, match="reaction wheels"):
        compose(load_experiment("song2023/attitude_1_7", ["plant={kind: pccs}", f"controller={base}"]))
    with pytest.raises(SpecError, match=r"plant\.step"):
        compose(load_experiment("song2023/pccs", ["plant.step=0.03"]))
    with pytest.raises(SpecError, match="plant"):
        compose(load_experiment("song2023/pccs", ["plant.kind=water"]))
