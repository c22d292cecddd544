"""Model-free control and PD where there is no compiler."""

from __future__ import annotations

import numpy as np

from space_robot_control.laws import make_law
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.interpreter import commands_without_numba
from tests.support.robots import random_state

GAINS = ({}, {"filter": {}, "input_order": 2, "estimator": {"sigma": 1.0}})


def commands() -> list[float]:
    """Commands and telemetry of a few periods of both laws on two robots, with and without a filter."""
    found: list[float] = []
    for name, gains in (("mfac", GAINS[0]), ("mfac", GAINS[1]), ("pd", {}), ("pd", {"filter": {}})):
        for robot in (load_robot("servicer"), load_robot("mini")):
            law, rng = make_law(name, robot, 0.1, gains), np.random.default_rng(3)
            for k in range(4):
                (q, v), (q_d, v_d) = (random_state(rng, robot.n, 0.1) for _ in range(2))
                state = RobotState(k, q, v, np.zeros(robot.n), np.zeros(3))
                output = law.update(state, Reference(k, q_d, v_d, rng.normal(size=6 + robot.n)))
                found += [*output.command.u.tolist(), *output.telemetry.data.tolist()]
    return found


def test_the_laws_run_without_numba() -> None:
    """The same text uncompiled gives the same commands and telemetry to 1e-12 of the largest, without a warning."""
    numbers, compiled = commands_without_numba(__name__), commands()
    np.testing.assert_allclose(numbers, compiled, rtol=1e-12, atol=1e-12 * np.abs(compiled).max())
