"""MuJoCo as the independent engine."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_msgs_py.interfaces import Command
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.robots import MujocoTwin, arm_model, random_model, random_state, robot_of

PERIOD = 100_000_000


def _efforts(joints: int, k: int) -> tuple[np.ndarray, np.ndarray]:
    """A lively body torque and joint efforts, held over period k."""
    phase = 0.6 * k + np.arange(3 + joints)
    size = np.concatenate([[4.0, 3.0, 2.0], np.geomspace(1.5, 0.02, joints)])
    both = size * np.cos(phase)
    return both[:3], both[3:]


@pytest.mark.parametrize("robot", ["arm", "tree"])
def test_mujoco_agrees_at_its_own_step_error(robot: str) -> None:
    """MuJoCo's RK4 differs from the plant by its own error: it shrinks 16-fold when its step is halved."""
    pytest.importorskip("mujoco")
    rng = np.random.default_rng(11)
    model = arm_model() if robot == "arm" else random_model(rng, 6, kinds=("RX", "RY", "RZ", "PX", "RevoluteUnaligned"))
    joints = model.nv - 6
    q, v = random_state(rng, joints, 0.2)
    plant = SimulatedRobot(robot_of(model), control_period=PERIOD, initial=InitialState(q, v))
    for k in range(20):
        torque, effort = _efforts(joints, k)
        ours = plant.step(Command(k * PERIOD, [0, 0, 0, *torque], effort)).state.q
    errors = []
    for steps in (10, 20, 40):
        twin = MujocoTwin(model, 0.1 / steps)
        twin.set(q, v)
        for k in range(20):
            twin.step(*_efforts(joints, k), steps)
        errors.append(np.abs(twin.q - ours).max())
    assert errors[1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.3)
    assert errors[1] / errors[2] == pytest.approx(16.0, rel=0.3)
