"""The damped hold: it is its reference, takes energy out in every state and period, and brings a robot to rest."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.damped_hold.law import DampedHold
from space_robot_control.laws.damped_hold.reference import DampedHold as OnOneScreen
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Command
from tests.support.at_rest import IDS, ROBOTS, samples_of_a_tumble
from tests.support.closed_loop import closed_loop, off, random_pair


def law_of(robot: Robot, rate: float = 0.5, period: float = 0.1) -> DampedHold:
    """The law with this gain."""
    return DampedHold(robot, period, DampedHold.Gains(rate=rate))


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference(robot: Robot) -> None:
    """Commands agree to 1e-12 of the largest entry, in random states with random gains and in a closed loop."""
    rng, floating = np.random.default_rng(1), robot.base_mode == "free_floating"
    for _ in range(40):
        omega, T = rng.uniform(0.05, 5.0), rng.uniform(0.02, 1.0)
        law, reference = law_of(robot, omega, T), OnOneScreen(robot.model, omega=omega, T=T, floating=floating)
        for stamp in range(2):
            state, desired = random_pair(rng, robot.n, stamp)
            assert off(law.update(state, desired).command.u, reference.update(state.q, state.v)) < 1e-12
    law, reference = law_of(robot), OnOneScreen(robot.model, omega=0.5, T=0.1, floating=floating)
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    ticks = closed_loop(law, robot, make_reference({"kind": "hold"}, robot, q), q, 10)
    for state, _, output in ticks:
        np.testing.assert_allclose(output.command.u, reference.update(state.q, state.v), atol=1e-12)


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_its_power_is_never_positive(robot: Robot) -> None:
    """In any state, whatever the reference, the command takes energy out of the robot."""
    rng, law = np.random.default_rng(2), law_of(robot)
    for stamp in range(50):
        state, desired = random_pair(rng, robot.n, stamp, speed=2.0)
        output = law.update(state, desired)
        assert output.telemetry["power"][0] <= 0.0
        assert np.all(output.command.u * state.v <= 0.0)


@pytest.mark.parametrize("rate", [0.3, 1.0, 50.0])
@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_sampled_damping_brings_the_robot_to_rest(robot: Robot, rate: float) -> None:
    """With any gain and 1 s between commands kinetic energy falls in every period, and rates vanish."""
    samples = list(samples_of_a_tumble(law_of(robot, rate, 1.0), robot, 0.005))
    sample, energies = samples[-1], [one.telemetry["energy"][0] for one in samples[:-1]]
    assert np.all(np.diff(energies) < 1e-15)
    # What is left of a free-floating robot is the drift of its centre of mass, which no actuator of it can change.
    momentum, mass = sample.telemetry["momentum"][:3], sum(one.mass for one in robot.model.inertias)
    drift = momentum @ momentum / (2.0 * mass)
    assert energies[-1] - drift < 1e-3 * (energies[0] - drift)
    np.testing.assert_allclose(sample.state.v[3:6], 0.0, atol=1e-4)


def test_a_command_is_not_positive_in_a_saturated_plant() -> None:
    """Clipped channel by channel a damper stays one."""
    robot = load_robot("mini")
    state, desired = random_pair(np.random.default_rng(4), robot.n, 0, speed=100.0)
    command: Command = law_of(robot).update(state, desired).command
    clipped = np.clip(command.effort, -robot.effort_limit, robot.effort_limit)
    assert np.all(clipped * state.joint_rates <= 0.0)
