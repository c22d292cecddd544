"""LQR: it is its reference, its gain is SciPy's, its sampled loop is stable whatever is accepted, and it tracks."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from space_robot_control.kernel import matrices
from space_robot_control.laws.lqr.kernel import riccati
from space_robot_control.laws.lqr.kernel.design import DesignMemory
from space_robot_control.laws.lqr.kernel.riccati import SOLVED, UNSOLVED, UNSTABLE, riccati_room, solve_riccati
from space_robot_control.laws.lqr.law import Lqr
from space_robot_control.laws.lqr.reference import Lqr as OnOneScreen
from space_robot_control.references import make_reference
from space_robot_description.kernel import jit
from space_robot_description.kernel.jit import kernel
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.at_rest import IDS, ROBOTS
from tests.support.closed_loop import closed_loop, off, random_pair


@kernel
def solved(a: Vector, b: Vector, room: Any, cost: Vector, gain: Vector, closed: Vector) -> int:
    """``solve_riccati`` from Python."""
    status: int = solve_riccati(a, b, room, cost, gain, closed)
    return status


def pair(robot: Robot, period: float, **gains: Any) -> tuple[Lqr, OnOneScreen]:
    """The law and its reference, of the same gains."""
    law, floating = Lqr(robot, period, Lqr.Gains(gyroscopic=False, **gains)), robot.base_mode == "free_floating"
    first, g = 3 if floating else 0, law.gains
    assert isinstance(g.joint_error, float)
    error = np.concatenate([np.full(6 - first, g.base_error), np.full(robot.n, g.joint_error)])
    return law, OnOneScreen(
        robot.model, period, error=error, tau=g.time, effort=law._effort, step=g.posture_step, floating=floating
    )


def design_at(robot: Robot, q: Vector, period: float, **gains: Any) -> DesignMemory:
    """The regulator of a posture."""
    law, still = pair(robot, period, **gains)[0], np.zeros(6 + robot.n)
    law.update(RobotState(0, q, still, np.zeros(robot.n), np.zeros(3)), Reference(0, q, still, still))
    return law.design


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference_in_random_states(robot: Robot) -> None:
    """Commands agree to 1e-10 of the largest entry: K is the limit of two different iterations."""
    rng = np.random.default_rng(1)
    for _ in range(6):
        base, joint, time = np.exp(rng.uniform(np.log([0.01, 0.01, 0.5]), np.log([1.0, 1.0, 10.0]))).tolist()
        law, reference = pair(robot, rng.uniform(0.1, 1.0), base_error=base, joint_error=joint, time=time)
        for stamp in range(2):
            state, desired = random_pair(rng, robot.n, stamp)
            expected = reference.update(state.q, state.v, desired.q, desired.v, desired.a)
            assert off(law.update(state, desired).command.u, expected) < 1e-10


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_it_equals_its_reference_in_a_closed_loop_and_computes_a_gain_per_posture(robot: Robot) -> None:
    """Over a motion of 20 deg K is computed again after every ``posture_step``, in both at the same ticks."""
    law, reference = pair(robot, 0.25)
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    goal = {"kind": "quintic", "duration": 5.0, "attitude_deg": [20, -10, 30], "joints_by_deg": 20}
    ticks = closed_loop(law, robot, make_reference(goal, robot, q), q, 30)
    found = np.array([output.command.u for _, _, output in ticks])
    expected = [reference.update(state.q, state.v, desired.q, desired.v, desired.a) for state, desired, _ in ticks]
    assert off(found, expected) < 1e-10
    assert 3 <= ticks[-1][2].telemetry["designs"][0] <= 5
    assert np.abs(ticks[-1][2].telemetry["joint_error"]).max() < 5e-3


@pytest.mark.parametrize("robot", ROBOTS[:2], ids=IDS[:2])
def test_the_gain_solves_the_riccati_equation_as_scipy_does(robot: Robot) -> None:
    """X is that of ``scipy.linalg.solve_discrete_are`` to 1e-7 of its largest entry, from stiff to soft."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    for error, period in ((0.001, 1.0), (0.1, 0.25), (10.0, 0.1)):
        design = design_at(robot, q, period, base_error=error, joint_error=error)
        s, m = design.b.shape
        X = solve_discrete_are(design.a, design.b, np.identity(s), np.identity(m))
        np.testing.assert_allclose(design.cost, X, rtol=0.0, atol=1e-7 * np.abs(X).max())


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("period", [0.1, 1.0])
def test_the_sampled_loop_is_stable_at_both_ends_of_every_range(end: str, period: float) -> None:
    """Whatever ``space-robot tune`` may try, the poles of the nominal loop lie inside the unit circle."""
    robot = ROBOTS[1]
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    design = design_at(robot, q, period, **{name: getattr(one, end) for name, one in Lqr.gain_ranges.items()})
    assert np.abs(np.linalg.eigvals(design.a - design.b @ design.gain)).max() < 1.0


@pytest.mark.parametrize("pole", [0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5])
def test_a_mode_that_no_input_reaches_is_an_error(pole: float) -> None:
    """A gain is given where the loop with it is stable, and only there; SciPy answers zero for a pole of 1."""
    a, b = np.array([[pole, 0.0], [0.0, 0.5]]), np.array([[0.0], [1.0]])
    cost, gain, closed = np.zeros((2, 2)), np.zeros((1, 2)), np.zeros((2, 2))
    status = solved(a, b, riccati_room(2, 1), cost, gain, closed)
    assert status in ((SOLVED,) if pole < 1.0 else (UNSOLVED, UNSTABLE))


def test_without_a_compiler_the_equation_is_solved_to_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plain Python text, whose rows are summed by NumPy, has every bit of the compiled one."""
    design = design_at(ROBOTS[1], np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *ROBOTS[1].home]), 0.25)
    s, m = design.b.shape
    monkeypatch.setattr(jit, "MACHINE_CODE", False)
    monkeypatch.setattr(jit, "numba", None)
    monkeypatch.setitem(sys.modules, matrices.__name__, loaded_again(matrices))
    cost, gain, closed = np.zeros((s, s)), np.zeros((m, s)), np.zeros((s, s))
    plain = loaded_again(riccati)
    assert plain.solve_riccati(design.a, design.b, plain.riccati_room(s, m), cost, gain, closed) == SOLVED
    for found, expected in ((cost, design.cost), (gain, design.gain), (closed, design.closed)):
        assert found.tobytes() == expected.tobytes()


def loaded_again(module: ModuleType) -> Any:
    """The module made from its file once more, under a name that no one imports."""
    spec = spec_from_file_location(f"plain_{module.__name__}", str(module.__file__))
    assert spec is not None
    assert spec.loader is not None
    again = module_from_spec(spec)
    spec.loader.exec_module(again)
    return again


def test_other_accepted_errors_act_from_the_next_update_on() -> None:
    """A change during a run makes the command that of a new law with these gains."""
    robot, rng = ROBOTS[0], np.random.default_rng(3)
    law, (state, desired) = Lqr(robot, 0.25, Lqr.Gains(gyroscopic=False)), random_pair(rng, robot.n, 0)
    law.update(state, desired)
    law.tune({"gains.base_error": 0.01})
    later, wanted = random_pair(rng, robot.n, 1)
    fresh = Lqr(robot, 0.25, Lqr.Gains(base_error=0.01, gyroscopic=False)).compute(later, wanted)[0]
    np.testing.assert_array_equal(law.compute(later, wanted)[0], fresh)
