"""A robot that has captured debris: balance, slip, a shift of the grasp, central gravity, and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
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
MODEL = load_robot("pccs").model
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


# Soft enough for long steps, stiff enough to hold.
SOFT = {"stiffness": 1.0, "damping": 1.0, "torsional_stiffness": 1.0, "torsional_damping": 1.0, "slip_torque": 9.0}


def centre(sample: PlantSample) -> tuple[Vector, Vector, Vector]:
    """Centre of mass, momentum and angular momentum about it, from the truth."""
    data, q = MODEL.createData(), np.array(sample.telemetry["true_configuration"])
    com = np.array(pin.centerOfMass(MODEL, data, q))
    momentum = sample.telemetry["momentum"]
    return com, momentum[:3], momentum[3:] - np.cross(com, momentum[:3])


@pytest.mark.parametrize("higher", [-2000.0, 0.0, 50.0])
def test_in_orbit_the_centre_of_mass_follows_kepler(higher: float) -> None:
    """Started on a circular orbit it is where Kepler has it, to a tenth of a millimetre over a whole one."""
    spec = OrbitSpec()
    r, n = spec.radius, Orbit(spec).rate
    other, n_other = r + higher, np.sqrt(spec.mu / (r + higher) ** 3)
    lever = centre(captured().reset())[0]
    start, speed = (higher, 0.0, 0.0) - lever, (0.0, other * n_other - r * n, 0.0)
    plant = captured(tuple(start), speed, 50_000_000_000, grasp=SOFT, orbit={}, step=5.0)
    samples = simulate(plant, (0.0,) * 6, 114)
    assert 2 * np.pi / n_other < 114 * 50.0
    for k, sample in enumerate(nonempty(samples)):
        t = 50.0 * k
        own, virtual = (size * np.array([np.cos(w * t), np.sin(w * t)]) for size, w in ((other, n_other), (r, n)))
        np.testing.assert_allclose(centre(sample)[0][:2], own - virtual, rtol=0.0, atol=1e-4)
    assert worst(samples, "momentum_residual") < 1e-9
    assert worst(samples, "energy_residual") < 1e-8


def test_the_gradient_of_gravity_turns_a_body() -> None:
    """At 45 deg to the vertical its torque is 3 n^2 dI / 2, and none where a principal axis is vertical."""
    orbit, here, inertia = Orbit(OrbitSpec()), np.zeros((2, 3)), np.tile(np.diag([2.0, 5.0, 4.0]), (2, 1, 1))
    slanted = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, np.sqrt(2.0)]]) / np.sqrt(2.0)
    torques = orbit.gradient_torque(0.0, here, np.array([slanted, np.eye(3)]), inertia)
    np.testing.assert_allclose(torques, [[0.0, 0.0, -3.0 * orbit.rate**2 * 3.0 / 2.0], [0.0] * 3], atol=1e-18)


def test_a_robot_in_orbit_is_turned_by_the_gradient() -> None:
    """Held still, robot and debris together gain the angular momentum 3 n^2 u x I u of one rigid body."""
    plant = captured(orbit={})
    samples = simulate(plant, (0.0,) * 6, 1)
    spin = centre(samples[-1])[2]
    data = MODEL.createData()
    pin.ccrba(MODEL, data, np.array(samples[0].telemetry["true_configuration"]), np.zeros(MODEL.nv))
    u = np.array([1.0, 0.0, 0.0])
    expected: Vector = 3.0 * Orbit(OrbitSpec()).rate ** 2 * np.cross(u, np.array(data.Ig.inertia) @ u)
    assert np.linalg.norm(expected) > 1e-6
    np.testing.assert_allclose(spin / 0.1, expected, rtol=1e-3, atol=1e-3 * float(np.linalg.norm(expected)))


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
