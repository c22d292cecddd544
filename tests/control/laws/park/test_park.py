"""Park: it is its reference, brings the arm to its posture within its bounds, from rest and from a tumble."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.park.law import Park
from space_robot_control.laws.park.reference import Park as OnOneScreen
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, Vector
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.closed_loop import off, random_pair
from tests.support.robots import random_model, robot_of

ROBOTS = [load_robot("mini"), load_robot("servicer"), robot_of(random_model(np.random.default_rng(5), 6, serial=True))]
IDS = ["mini", "servicer", "arm"]


def law_of(robot: Robot, period: float = 0.5, **gains: Any) -> Park:
    """The law with these gains."""
    return Park(robot, period, Park.Gains(**gains))


def parked(robot: Robot, law: Park, v: Vector, steps: int) -> tuple[Vector, Vector, Vector]:
    """Path rates (K, n) on the way, joints (n,) and velocity (6+n,) at the end of a run from home."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    period = round(law.control_period * 1e9)
    plant = SimulatedRobot(robot, control_period=period, initial=InitialState(q, v))
    sample, rates, limits = plant.reset(), [], CommandLimits(robot)
    for _ in range(steps):
        still = Reference(sample.state.stamp, q, np.zeros_like(v), np.zeros_like(v))
        output = law.update(sample.state, still)
        assert limits.fits(output.command.u * (1.0 - 1e-12))
        rates.append(output.telemetry["path_rate"])
        sample = plant.step(output.command)
    return np.array(rates), sample.state.joints, sample.state.v


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference(robot: Robot) -> None:
    """Commands agree to 1e-12 of the largest entry, with random gains and postures; the path is the same, too."""
    rng, floating = np.random.default_rng(1), robot.base_mode == "free_floating"
    low, high = np.maximum(robot.joint_lower, -3.0), np.minimum(robot.joint_upper, 3.0)
    for _ in range(40):
        omega, T, v_max, A = rng.uniform(0.05, 5.0), rng.uniform(0.02, 1.0), rng.uniform(0.01, 1), rng.uniform(0.01, 1)
        posture = rng.uniform(low, high)
        law = law_of(robot, T, rate=omega, speed=v_max, acceleration=A, posture=tuple(posture.tolist()))
        reference = OnOneScreen(robot.model, omega=omega, v_max=v_max, A=A, q_p=posture, T=T, floating=floating)
        for stamp in range(3):
            state, desired = random_pair(rng, robot.n, stamp)
            output = law.update(state, desired)
            assert off(output.command.u / output.telemetry["scale"][0], reference.update(state.q, state.v)) < 1e-12
            if output.telemetry["scale"][0] < 1.0:
                break


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_the_arm_goes_to_its_posture_within_the_limits_of_the_path(robot: Robot) -> None:
    """From rest: no rate and no change of rate beyond its bound, never past the posture, and there it rests."""
    posture = robot.home + np.where(np.arange(robot.n) % 2, 0.4, -0.3)
    law = law_of(robot, rate=1.0, posture=tuple(posture.tolist()))
    rates, joints, v = parked(robot, law, np.zeros(6 + robot.n), 160)
    assert np.abs(rates).max() <= law.gains.speed * (1.0 + 1e-12)
    assert np.abs(np.diff(rates, axis=0)).max() <= law.gains.acceleration * 0.5 * (1.0 + 1e-9)
    assert (rates * np.sign(posture - robot.home) >= -1e-12).all()
    np.testing.assert_allclose(joints, posture, atol=1e-3)
    np.testing.assert_allclose(v[3:], 0.0, atol=1e-4)


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_a_tumbling_robot_comes_to_rest_and_parks(robot: Robot) -> None:
    """It begins with the rates there are, brings the base to rest and the arm home, whatever the actuators allow."""
    rng = np.random.default_rng(3)
    v = np.concatenate([[0.0] * 3, rng.normal(size=3) * 0.01, rng.normal(size=robot.n) * 0.02])
    _, joints, v = parked(robot, law_of(robot, rate=1.0), v, 240)
    np.testing.assert_allclose(joints, robot.home, atol=1e-3)
    np.testing.assert_allclose(v[3:], 0.0, atol=1e-4)


def test_a_posture_beyond_a_limit_is_refused() -> None:
    """With the joint and its limits."""
    with pytest.raises(SpecError, match="beyond the joint's limits"):
        law_of(load_robot("mini"), posture={"joint2": 99.0})
