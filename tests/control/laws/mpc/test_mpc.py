"""MPC: it is its reference, LQR where no limit is met, keeps every limit, and says when its solver gives up."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.lqr.law import Lqr
from space_robot_control.laws.mpc import law as module
from space_robot_control.laws.mpc.law import LinearMpc
from space_robot_control.laws.mpc.reference import Mpc
from space_robot_control.laws.mpc.solver import solve
from space_robot_control.references import make_reference
from space_robot_description.actuation import command_limit
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.at_rest import IDS, ROBOTS
from tests.support.closed_loop import closed_loop, off, random_pair

STIFF: dict[str, Any] = {"base_error": 0.001, "joint_error": 0.001, "time": 0.5}


def step(robot: Robot, size: float) -> tuple[RobotState, Reference]:
    """At rest at home, desired a step of the base about each axis and of every joint [rad]."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    goal = np.array(q)
    goal[7:] += size
    half = 0.5 * size
    goal[3:7] = np.array([half, half, half, 1.0]) / np.linalg.norm([half, half, half, 1.0])
    still = np.zeros(6 + robot.n)
    return RobotState(0, q, still, np.zeros(robot.n), np.zeros(3)), Reference(0, goal, still, still)


@pytest.mark.parametrize("horizon", [1, 7])
@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_is_lqr_where_no_limit_is_met(robot: Robot, horizon: int) -> None:
    """For every horizon the command is the regulator's to 1e-9 of the largest entry, and no solver is called."""
    state, desired = step(robot, 1e-4)
    law = LinearMpc(robot, 0.25, LinearMpc.Gains(horizon=horizon, base_error=0.5, joint_error=0.5))
    output = law.update(state, desired)
    regulator = Lqr(robot, 0.25, Lqr.Gains(base_error=0.5, joint_error=0.5)).update(state, desired)
    assert off(output.command.u, regulator.command.u) < 1e-9
    assert output.telemetry["limited"][0] == 0.0


def test_weights_that_are_far_apart_are_no_reason_to_give_up() -> None:
    """Gains of a search, whose problem has a condition of 1e12: every base rate has an answer within the limits."""
    robot, rng = load_robot("servicer"), np.random.default_rng(0)
    gains = LinearMpc.Gains(base_error=0.022019233383415687, joint_error=0.0037606313322259364, time=5.961389704037108)
    q, still = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home]), np.zeros(6 + robot.n)
    limited, most = 0, command_limit(robot)
    for _ in range(20):
        rate = rng.normal(size=3)
        v = np.concatenate([np.zeros(3), rate * (rng.uniform(0.005, 0.015) / np.linalg.norm(rate)), np.zeros(robot.n)])
        state = RobotState(0, q, v, np.zeros(robot.n), np.zeros(3))
        output = LinearMpc(robot, 0.1, gains).update(state, Reference(0, q, still, still))
        assert (np.abs(output.command.u) <= most * (1.0 + 1e-6)).all()
        limited += int(output.telemetry["limited"][0])
    assert limited > 10


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_it_equals_its_reference_where_limits_are_met(robot: Robot) -> None:
    """The first input of a problem with active limits is that of another algorithm, to 1e-6 of the largest one."""
    state, desired = step(robot, 1.0)
    law = LinearMpc(robot, 0.5, LinearMpc.Gains(horizon=3, **STIFF))
    output = law.update(state, desired)
    assert output.telemetry["limited"][0] == 1.0
    floating = robot.base_mode == "free_floating"
    first, limits = 3 if floating else 0, CommandLimits(robot)
    every = np.vstack(
        [
            np.identity(6 + robot.n),
            np.hstack([np.zeros((len(limits.share), 3)), limits.share, np.zeros((len(limits.share), robot.n))]),
        ]
    )[:, first:]
    there = np.isfinite(limits.channels) & (np.abs(every).max(axis=1) > 0.0)
    error = np.full(6 + robot.n - first, 0.001)
    reference = Mpc(
        robot.model,
        0.5,
        N=3,
        S=every[there],
        limit=limits.channels[there],
        error=error,
        tau=0.5,
        effort=law._effort,
        step=0.1,
        floating=floating,
    )
    expected = reference.update(state.q, state.v, desired.q, desired.v, desired.a)
    assert off(output.command.u, expected) < 1e-6


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_no_command_is_beyond_a_limit_and_the_robot_arrives(robot: Robot) -> None:
    """After a step that wants more than the actuators have every command fits, wheels too, and errors vanish."""
    limits, law = CommandLimits(robot), LinearMpc(robot, 0.5, LinearMpc.Gains(**STIFF))
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    goal = {"kind": "step", "time": 0.0, "attitude_deg": [60, -30, 30], "joints_by_deg": 10}
    ticks = closed_loop(law, robot, make_reference(goal, robot, q), q, 100)
    assert sum(output.telemetry["limited"][0] for _, _, output in ticks) >= 2
    for _, _, output in ticks:
        assert limits.fits(output.command.u * (1.0 - 1e-9))
    assert np.abs(ticks[-1][2].telemetry["joint_error"]).max() < 2e-3
    assert np.abs(ticks[-1][2].telemetry["attitude_error"]).max() < 2e-3


def test_equal_states_get_equal_bits_whatever_was_solved_before() -> None:
    """A problem is solved from its beginning: a law that has solved others answers as a new one does."""
    robot, rng = ROBOTS[0], np.random.default_rng(2)
    used, state, desired = LinearMpc(robot, 0.5, LinearMpc.Gains(**STIFF)), *step(robot, 1.0)
    for stamp in range(5):
        used.update(*random_pair(rng, robot.n, stamp))
    used.reset()
    fresh = LinearMpc(robot, 0.5, LinearMpc.Gains(**STIFF)).update(state, desired)
    np.testing.assert_array_equal(used.update(state, desired).command.u, fresh.command.u)


def test_a_solver_that_does_not_converge_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its last iterate is never a command."""
    state, desired = step(ROBOTS[0], 1.0)
    monkeypatch.setattr(module, "solve", lambda *problem: solve(*problem, max_iterations=1))
    with pytest.raises(ControlError, match=r"did not converge.*PIQP_MAX_ITER_REACHED"):
        LinearMpc(ROBOTS[0], 0.5, LinearMpc.Gains(**STIFF)).update(state, desired)


def test_crossed_bounds_and_numbers_that_are_not_finite_are_refused() -> None:
    """Before the solver sees them: some solvers call both solved."""
    one, none = np.identity(2), np.zeros((0, 2))
    empty = (np.zeros(0), np.zeros(0))
    with pytest.raises(ControlError, match="crossed"):
        solve(one, np.zeros(2), (np.array([0.0, 1.0]), np.array([1.0, 0.0])), none, empty)
    with pytest.raises(ControlError, match="not finite"):
        solve(one, np.array([0.0, np.nan]), (np.full(2, -1.0), np.ones(2)), none, empty)


def test_without_the_package_the_law_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the command that installs it, before a run."""
    monkeypatch.setattr("space_robot_control.laws.mpc.solver.find_spec", lambda name: None)
    with pytest.raises(SpecError, match=r"piqp.*\[mpc\]"):
        LinearMpc(ROBOTS[0], 0.5)
