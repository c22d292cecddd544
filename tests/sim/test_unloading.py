"""Thrusters unload the wheels: the base feels nothing of it, and momentum and energy are accounted for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.initial import InitialState
from space_robot_sim.plant import SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from tests.support.robots import arm_model, random_state, robot_of

PERIOD = 100_000_000
LIMIT = (0.5, 0.6, 0.7)
HELD = (1.0, 0.3, -0.2)
WHEELS = {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": HELD, "unloading": LIMIT}


def plant_of(*, moving: bool = False, kernel: str = "auto", **wheels: Any) -> SimulatedRobot:
    """An arm on a base with wheels that turn already, and thrusters."""
    robot = robot_of(arm_model(), {"joints": {"effort": 9.0}, "base_torque": WHEELS | wheels}, floating=True)
    q, v = random_state(np.random.default_rng(0), 7, 0.2)
    initial = InitialState(q, v if moving else 0.0 * v)
    integrator = IntegratorSpec(kernel=kernel)  # type: ignore[arg-type]
    return SimulatedRobot(robot, control_period=PERIOD, initial=initial, integrator=integrator, unloads=True)


def simulate(plant: SimulatedRobot, modes: str, torque: tuple[float, float, float] = (0, 0, 0)) -> list[PlantSample]:
    """A period per letter, with wheels unloaded where it is ``u``."""
    samples = [plant.reset()]
    for tick, letter in enumerate(modes):
        plant.unload_wheels(letter == "u")
        samples.append(plant.step(Command(tick * PERIOD, [0, 0, 0, *torque], np.zeros(7))))
    return samples


def block(samples: list[PlantSample], label: str) -> Vector:
    """A row per sample."""
    return np.array([sample.telemetry[label] for sample in samples])


def test_wheels_are_unloaded_at_the_thrusters_limit_and_the_base_rests() -> None:
    """To zero and no further; before and afterwards nothing fires."""
    samples = simulate(plant_of(), "--" + 24 * "u" + "--")
    held = block(samples, "wheel_momentum")
    np.testing.assert_array_equal(held[:3], [HELD] * 3)
    np.testing.assert_allclose(held[3] - held[2], [-0.05, -0.06, 0.07], atol=1e-12)
    np.testing.assert_allclose(held[-1], 0.0, atol=1e-12)
    np.testing.assert_allclose(block(samples, "true_velocity"), 0.0, atol=1e-12)
    fired = block(samples, "unloading")
    np.testing.assert_array_equal(fired[:, 0], [0] * 3 + [1] * 24 + [0] * 2)
    np.testing.assert_allclose(fired[3], [1, -0.5, -0.6, 0.7])
    assert not fired[-2:].any()


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
def test_a_moving_robot_balances_while_its_wheels_are_unloaded(kernel: str) -> None:
    """What thrusters take out is accounted for, in both forms of the plant."""
    samples = simulate(plant_of(moving=True, kernel=kernel), "-" + 8 * "u" + "--", (0.2, -0.1, 0.3))
    assert block(samples, "momentum_residual").max() < 1e-9
    assert block(samples, "energy_residual").max() < 1e-9
    # The base gets what is commanded.
    np.testing.assert_allclose(block(samples, "applied_wrench")[1:, 3:], [[0.2, -0.1, 0.3]] * 11, atol=1e-12)


def test_a_wheel_that_is_busy_is_not_unloaded() -> None:
    """As much is given as every wheel has torque left for; the command has priority."""
    samples = simulate(plant_of(), 3 * "u", (1.75, 0.0, 0.0))
    np.testing.assert_allclose(block(samples, "unloading")[1], [1, *(0.5 * np.array([-0.5, -0.6, 0.7]))], atol=1e-9)
    np.testing.assert_allclose(block(samples, "applied_wrench")[1:, 3:], [[1.75, 0, 0]] * 3, atol=1e-12)


def test_without_a_mode_that_unloads_no_bit_changes() -> None:
    """The robot of before, with thrusters that are never used."""
    with_them, without = (simulate(plant_of(moving=True, unloading=limit), 5 * "-") for limit in (LIMIT, (9, 9, 9)))
    assert block(with_them, "true_configuration").tobytes() == block(without, "true_configuration").tobytes()
