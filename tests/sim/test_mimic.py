"""A plant of which joints follow others: a hand closes, momentum and energy are kept, both integrators agree."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Command, PlantSample
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from tests.support.coupled_robots import random_coupled
from tests.support.robots import random_state, robot_of

PERIOD = 100_000_000
ROUGH = {"joints": {"effort": 1e3, "lag": 0.05, "viscous": 0.3, "coulomb": 0.02, "brake": 1e3}}


def _robot(seed: int, actuators: dict[str, Any] | None = None) -> Robot:
    return robot_of(random_coupled(np.random.default_rng(seed), 6, serial=True).model, actuators)


def _run(robot: Robot, kernel: Literal["auto", "pinocchio"] = "auto", *, brake_at: int = -1) -> list[PlantSample]:
    n = robot.n
    initial = InitialState(*random_state(np.random.default_rng(1), n, 0.1))
    spec = IntegratorSpec(kernel=kernel)
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=initial, integrator=spec, braked=brake_at >= 0)
    samples = [plant.reset()]
    for k in range(20):
        if k == brake_at:
            plant.close_brakes(closed=True)
        wave = float(np.cos(0.3 * k))
        samples.append(plant.step(Command(k * PERIOD, wave * np.arange(1.0, 7.0), wave * np.linspace(0.3, 0.1, n))))
    return samples


def _residuals(sample: PlantSample) -> float:
    return float(max(sample.telemetry["momentum_residual"].max(), sample.telemetry["energy_residual"].max()))


@pytest.mark.parametrize("actuators", [{}, ROUGH], ids=["ideal", "lag and friction"])
@pytest.mark.parametrize("seed", [6, 7, 8])
def test_momentum_and_energy_of_followers_balance(seed: int, actuators: dict[str, Any]) -> None:
    """Under forces and efforts the residuals are those of a robot without followers: the constraint does no work."""
    samples = _run(_robot(seed, actuators))
    assert max(map(_residuals, samples)) < 1e-9
    assert samples[-1].telemetry["energy"][0] > 0.1


def test_both_integrators_agree_on_followers() -> None:
    """The compiled kernel and the one over Pinocchio give the same motion to 1e-9 of it."""
    robot = _robot(6)
    found, expected = (_run(robot, kernel)[-1].state for kernel in ("auto", "pinocchio"))
    np.testing.assert_allclose(np.r_[found.q, found.v], np.r_[expected.q, expected.v], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
def test_a_brake_holds_a_joint_with_its_followers(kernel: Literal["auto", "pinocchio"]) -> None:
    """Closed brakes stop the coordinates and so all joints; momentum and energy with the brakes' work balance."""
    samples = _run(_robot(6, ROUGH), kernel, brake_at=10)
    assert np.abs(samples[10].state.joint_rates).max() > 1e-3
    assert not samples[-1].state.joint_rates.any()
    assert max(map(_residuals, samples)) < 1e-9
