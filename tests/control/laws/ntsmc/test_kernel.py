"""The kernels of tracking errors and terminal sliding mode: also as plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws import make_law
from space_robot_control.tracking import tracking_errors
from space_robot_description import rotations as rot
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.interpreter import commands_without_numba
from tests.support.robots import random_state


def commands() -> list[float]:
    """Commands and telemetry of a few periods of both laws, with and without the clamp, free-flying and floating."""
    found: list[float] = []
    for name in ("ntsmc", "ntsmc_euler"):
        for robot in (load_robot("servicer"), load_robot("mini")):
            for clamp in (False, True):
                law, rng = make_law(name, robot, 0.1, {"clamp": clamp}), np.random.default_rng(3)
                for k in range(3):
                    (q, v), (q_d, v_d) = (random_state(rng, robot.n, 0.1) for _ in range(2))
                    state = RobotState(k, q, v, np.zeros(robot.n), np.zeros(3))
                    output = law.update(state, Reference(k, q_d, v_d, rng.normal(size=6 + robot.n)))
                    found += [*output.command.u.tolist(), *output.telemetry.data.tolist()]
    return found


def test_the_laws_run_without_numba() -> None:
    """The same text uncompiled gives the same commands and telemetry to 1e-12 of the largest, without a warning."""
    numbers, compiled = commands_without_numba(__name__), commands()
    np.testing.assert_allclose(numbers, compiled, rtol=1e-12, atol=1e-12 * np.abs(compiled).max())


@pytest.mark.parametrize("seed", range(20))
def test_tracking_errors_are_their_definition(seed: int) -> None:
    """Errors and feed-forward equal the formulas of ``TrackingErrors`` evaluated with matrices, to 1e-12."""
    rng = np.random.default_rng(seed)
    (q, v), (q_d, v_d) = (random_state(rng, 2, 0.5) for _ in range(2))
    a_d = rng.normal(size=8)
    found = tracking_errors(RobotState(0, q, v, np.zeros(2), np.zeros(3)), Reference(0, q_d, v_d, a_d))
    turn, turn_d = rot.matrix(q[3:7]), rot.matrix(q_d[3:7])
    to_body, omega = turn.T @ turn_d, v[3:6]
    seen = to_body @ v_d[3:6]
    rotation = np.array(rot.log(rot.relative(q[3:7], q_d[3:7])))
    configuration = [*(turn.T @ (q_d[:3] - q[:3])), *rotation, *(q_d[7:] - q[7:])]
    velocity = [*(to_body @ v_d[:3] - v[:3]), *(seen - omega), *(v_d[6:] - v[6:])]
    push = to_body @ (a_d[:3] + np.cross(v_d[3:6], v_d[:3])) - np.cross(omega, v[:3])
    feedforward = [*push, *(to_body @ a_d[3:6] - np.cross(omega, seen)), *a_d[6:]]
    for got, wanted in zip(
        (found.configuration, found.velocity, found.feedforward), (configuration, velocity, feedforward), strict=True
    ):
        np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-12)
    assert found.quaternion[3] >= 0.0
