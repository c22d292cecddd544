"""Detumble: it is its reference, brings a tumbling robot to rest, and keeps the arm in its shape."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.detumble.law import Detumble
from space_robot_control.laws.detumble.reference import Detumble as OnOneScreen
from space_robot_description.robot import Robot
from tests.support.at_rest import IDS, ROBOTS, samples_of_a_tumble
from tests.support.closed_loop import off, random_pair


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
    *_, sample = samples_of_a_tumble(law_of(robot, rate, 1.0), robot, 0.01)
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
