"""PD is its reference: the same equations with explicit matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.laws.pd.law import ProportionalDerivative
from space_robot_control.laws.pd.reference import Pd
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from tests.support.closed_loop import closed_loop, off, random_pair
from tests.support.coupled_robots import random_coupled
from tests.support.robots import random_model, robot_of

PERIOD = 0.1
ROBOTS = [load_robot("mini"), load_robot("servicer"), robot_of(random_model(np.random.default_rng(5), 6, serial=True))]
ROBOTS.append(robot_of(random_coupled(np.random.default_rng(6), 7, serial=True).model, floating=True))
IDS = ["mini", "servicer", "arm", "followers"]


def pair(robot: Robot, gains: dict[str, Any]) -> tuple[ProportionalDerivative, Pd]:
    """The law and its reference, of the same gains."""
    law = ProportionalDerivative(robot, PERIOD, ProportionalDerivative.Gains.model_validate(gains))
    names = ["x", "y", "z", "roll", "pitch", "yaw", *robot.joint_names]
    channels, held = ([names.index(name) for name in some] for some in (law.channels.names, law.gains.held))
    omega_n = np.array([gains["bandwidth"][name] for name in law.channels.names])
    home = [float(robot.home[index - 6]) for index in held]
    return law, Pd(robot.model, channels, held=held, home=home, omega_n=omega_n, zeta=law.gains.damping)


def some_gains(robot: Robot, rng: np.random.Generator) -> dict[str, Any]:
    """Random gains of a random choice of channels, one joint held."""
    held, *joints = rng.permutation(robot.joint_names).tolist()
    base = ["roll", "pitch", "yaw"] if robot.base_mode == "free_floating" else ["x", "y", "z", "roll", "pitch", "yaw"]
    outputs = rng.permutation([*base, *joints])[: rng.integers(2, 4 + len(joints))].tolist()
    bandwidth = {name: rng.uniform(0.1, 2.0) for name in outputs}
    return {"outputs": outputs, "held": [held], "bandwidth": bandwidth, "damping": rng.uniform(0.5, 1.5)}


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_pd_equals_its_reference_in_random_states(robot: Robot) -> None:
    """Commands agree to 1e-12 of the largest entry over random states, references, gains, channels and held joints."""
    rng = np.random.default_rng(1)
    for _ in range(40):
        law, reference = pair(robot, some_gains(robot, rng))
        for stamp in range(2):
            state, desired = random_pair(rng, robot.n, stamp)
            u = reference.update(state.q, state.v, desired.q, desired.v)
            assert off(law.update(state, desired).command.u, u) < 1e-12


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_pd_equals_its_reference_in_a_closed_loop(robot: Robot) -> None:
    """The commands of a run agree to 1e-12 of the largest; B stays that of the first configuration in both."""
    names = ["roll", "pitch", "yaw", *robot.joint_names]
    law, reference = pair(robot, {"outputs": names, "bandwidth": dict.fromkeys(names, 0.5)})
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    goal = {"kind": "quintic", "duration": 5.0, "attitude_deg": [20, -10, 30], "joints_by_deg": 5}
    ticks = closed_loop(law, robot, make_reference(goal, robot, q), q, 60)
    found = np.array([output.command.u for _, _, output in ticks])
    expected = [reference.update(state.q, state.v, desired.q, desired.v) for state, desired, _ in ticks]
    assert off(found, expected) < 1e-12
