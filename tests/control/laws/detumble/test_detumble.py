"""Detumble: it is its reference, brings a tumbling robot to rest, and keeps the arm in its shape."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.detumble.law import Detumble
from space_robot_control.laws.detumble.reference import Detumble as OnOneScreen
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.closed_loop import off, random_pair
from tests.support.robots import random_model, robot_of

ROBOTS = [load_robot("mini"), load_robot("servicer"), robot_of(random_model(np.random.default_rng(5), 6, serial=True))]
IDS = ["mini", "servicer", "arm"]


def law_of(robot: Robot, rate: float = 0.5, period: float = 0.1) -> Detumble:
    """The law with this gain."""
    return Detumble(robot, period, Detumble.Gains(rate=rate))


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference(robot: Robot) -> None:
    """Commands agree to 1e-12 of the largest entry, with random gains; the shape is that of the first state in both."""
    rng, floating = np.random.default_rng(1), robot.base_mode == "free_floating"
    for _ in range(40):
        omega, T = rng.uniform(0.05, 5.0), rng.uniform(0.02, 1.0)
        law, reference = law_of(robot, omega, T), OnOneScreen(robot.model, omega=omega, T=T, floating=floating)
        for stamp in range(3):
            state, desired = random_pair(rng, robot.n, stamp)
            output = law.update(state, desired)
            u = output.command.u / output.telemetry["scale"][0]
            assert off(u, reference.update(state.q, state.v)) < 1e-12


@pytest.mark.parametrize("rate", [0.3, 1.0, 50.0])
@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_a_tumbling_robot_comes_to_rest_in_its_shape(robot: Robot, rate: float) -> None:
    """With any gain and 1 s between commands rates vanish and the joints are back where they were."""
    rng, period = np.random.default_rng(3), 1_000_000_000
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    v = np.concatenate([[0.0] * 3, rng.normal(size=3) * 0.01, rng.normal(size=robot.n) * 0.01])
    plant = SimulatedRobot(robot, control_period=period, initial=InitialState(q, v))
    law, sample = law_of(robot, rate, 1.0), plant.reset()
    for _ in range(400):
        still = Reference(sample.state.stamp, q, np.zeros_like(v), np.zeros_like(v))
        sample = plant.step(law.update(sample.state, still).command)
    np.testing.assert_allclose(sample.state.v[3:], 0.0, atol=1e-4)
    np.testing.assert_allclose(sample.state.joints, robot.home, atol=1e-3)


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_a_command_fits_the_actuators_and_takes_energy_out(robot: Robot) -> None:
    """In the first state, however fast it tumbles, no channel is beyond its limit and the power is negative."""
    rng, law, limits = np.random.default_rng(4), law_of(robot, 2.0), CommandLimits(robot)
    for stamp, speed in enumerate((0.01, 1.0, 100.0)):
        state, desired = random_pair(rng, robot.n, stamp, speed)
        law.reset()
        output = law.update(state, desired)
        assert limits.fits(output.command.u * (1.0 - 1e-12))
        assert state.v @ output.command.u < 0.0
        assert (output.telemetry["scale"][0] < 1.0) == (speed > 0.01)
