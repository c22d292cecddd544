"""Computed torque is its reference: the same equations with explicit matrices."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.computed_torque.law import ComputedTorque
from space_robot_control.laws.computed_torque.reference import computed_torque
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.closed_loop import closed_loop, off, random_pair
from tests.support.coupled_robots import random_coupled
from tests.support.robots import random_model, robot_of

PERIOD = 0.1
ROBOTS = [load_robot("mini"), load_robot("servicer")]
MODELS = [random_model(np.random.default_rng(seed), 3 + seed, serial=True) for seed in range(4)]
ROBOTS += [robot_of(model, floating=index % 2 == 0) for index, model in enumerate(MODELS)]
ROBOTS.append(robot_of(random_coupled(np.random.default_rng(6), 7, serial=True).model, floating=True))
IDS = ["mini", "servicer", "arm 3", "arm 4", "arm 5", "arm 6", "followers"]


def by_the_reference(law: ComputedTorque, state: RobotState, desired: Reference) -> Vector:
    """The command of the reference with the law's gains."""
    robot, bandwidth = law.robot, law.gains.bandwidth
    omega_n = np.empty(6 + robot.n)
    omega_n[:3], omega_n[3:6], omega_n[6:] = bandwidth.translation, bandwidth.rotation, bandwidth.joints
    floating = robot.base_mode == "free_floating"
    values = state.q, state.v, desired.q, desired.v, desired.a
    return computed_torque(robot.model, *values, omega_n=omega_n, zeta=law.gains.damping, free_floating=floating)


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_computed_torque_equals_its_reference_in_random_states(robot: Robot) -> None:
    """Commands agree to 1e-12 of the largest entry over random states, references and gains, in both base modes."""
    rng = np.random.default_rng(1)
    for _ in range(40):
        axes = rng.uniform(0.1, 2.0, size=(2, 3)).tolist()
        bandwidth = {"translation": axes[0], "rotation": axes[1], "joints": rng.uniform(0.1, 2.0, robot.n).tolist()}
        gains = {"bandwidth": bandwidth, "damping": rng.uniform(0.5, 1.5)}
        law = ComputedTorque(robot, PERIOD, ComputedTorque.Gains.model_validate(gains))
        state, desired = random_pair(rng, robot.n)
        assert off(law.update(state, desired).command.u, by_the_reference(law, state, desired)) < 1e-12


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_computed_torque_equals_its_reference_in_a_closed_loop(robot: Robot) -> None:
    """The commands of a run agree to 1e-12 of the largest."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    goal = {"kind": "quintic", "duration": 5.0, "attitude_deg": [20, -10, 30], "joints_by_deg": 5}
    law = ComputedTorque(robot, PERIOD, ComputedTorque.Gains(gyroscopic=False))
    ticks = closed_loop(law, robot, make_reference(goal, robot, q), q, 60)
    found = np.array([output.command.u for _, _, output in ticks])
    assert off(found, [by_the_reference(law, state, desired) for state, desired, _ in ticks]) < 1e-12
