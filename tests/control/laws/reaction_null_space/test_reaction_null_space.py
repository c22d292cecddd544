"""Reaction null space: it is its reference, its arm motion does not turn the base, and a small weight follows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.laws.reaction_null_space.law import ReactionNullSpace
from space_robot_control.laws.reaction_null_space.reference import ReactionNullSpace as OnOneScreen
from space_robot_control.nominal_model import NominalModel
from space_robot_control.references import make_reference
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector
from tests.support.at_rest import IDS, ROBOTS
from tests.support.closed_loop import closed_loop, off, random_pair


def law_of(robot: Robot, period: float = 0.1, **gains: Any) -> ReactionNullSpace:
    """The law with these gains."""
    return ReactionNullSpace(robot, period, ReactionNullSpace.Gains(**gains))


def jacobian_of(robot: Robot, q: Vector) -> Vector:
    """J of the base, from the mass matrix of Pinocchio."""
    base, inertia = 3 if robot.base_mode == "free_floating" else 6, NominalModel(robot).actuated_mass_matrix(q)
    return -np.array(np.linalg.solve(inertia[:base, :base], inertia[:base, base:]))


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference(robot: Robot) -> None:
    """Commands agree to 1e-9 of the largest entry; to 1e-12 with a weight of 1, where nothing cancels."""
    rng, floating = np.random.default_rng(1), robot.base_mode == "free_floating"
    for weight, close in ((1.0, 1e-12), (1000.0, 1e-9)):
        for _ in range(10):
            k, w, wn, T = (float(number) for number in rng.uniform(0.1, 1.0, size=4))
            law = law_of(robot, T, stiffness=k, rate=w, bandwidth=wn, weight=weight)
            reference = OnOneScreen(robot.model, T, k=k, w=w, omega_n=wn, weight=weight, floating=floating)
            state, desired = random_pair(rng, robot.n)
            expected = reference.update(state.q, state.v, desired.q, desired.v, desired.a)
            assert off(law.update(state, desired).command.u, expected) < close


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_commanded_rates_give_the_base_no_velocity(robot: Robot) -> None:
    """With a large weight |J s| is a thousandth of |J r| at most; the part of r in the null space is whole."""
    rng = np.random.default_rng(2)
    for stamp in range(20):
        law, (state, desired) = law_of(robot, weight=1e4), random_pair(rng, robot.n, stamp)
        telemetry = law.update(state, desired).telemetry
        jacobian = jacobian_of(robot, state.q)
        asked = desired.v[6:] + law.gains.stiffness * telemetry["joint_error"]
        assert np.linalg.norm(telemetry["reaction"]) < 1e-3 * np.linalg.norm(jacobian @ asked) + 1e-9
        _, sizes, rows = np.linalg.svd(jacobian)
        null = rows[int((sizes > 1e-6).sum()) :]
        np.testing.assert_allclose(null @ telemetry["rate_command"], null @ asked, atol=1e-6)


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_the_base_needs_no_torque_while_the_arm_moves(robot: Robot) -> None:
    """The angular impulse on the base is a twentieth of what a small weight takes for the same reference."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    source = make_reference({"kind": "quintic", "duration": 20.0, "joints_by_deg": 20}, robot, q)
    impulse, moved = {}, {}
    for weight in (0.01, 1000.0):
        ticks = closed_loop(law_of(robot, weight=weight), robot, source, q, 200)
        impulse[weight] = sum(np.abs(output.command.u[3:6]).sum() for _, _, output in ticks)
        moved[weight] = np.abs(ticks[-1][0].joints - robot.home).max()
        assert np.abs(ticks[-1][2].telemetry["attitude_error"]).max() < 1e-3
    assert impulse[1000.0] < 0.05 * impulse[0.01]
    assert moved[1000.0] > np.radians(2.0)


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_a_small_weight_follows_the_reference(robot: Robot) -> None:
    """Then it is a law like others: the joints arrive."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    source = make_reference({"kind": "quintic", "duration": 20.0, "joints_by_deg": 20}, robot, q)
    ticks = closed_loop(law_of(robot, weight=0.1), robot, source, q, 300)
    assert np.abs(ticks[-1][2].telemetry["joint_error"]).max() < 2e-3
