"""The compiled cycle of the adaptive law against the same equations over Pinocchio, and where it is not compiled."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.modes import compilation as compiling
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.euler_coordinates import euler_state
from space_robot_control.laws.adaptive.kernel.consistency import assess
from space_robot_control.laws.adaptive.kernel.control import control
from space_robot_control.laws.adaptive.kernel.least_squares import covariance_times
from space_robot_control.laws.adaptive.kernel.regressor import slotine_li
from space_robot_control.laws.adaptive.kernel.tree import places, tree_of
from space_robot_control.laws.adaptive.kernel.workspace import PeriodStart
from space_robot_control.laws.adaptive.law import Adaptive
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.laws.computed_torque.law import ComputedTorque
from space_robot_description.kernel import jit
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy, rotate, rotate_inverse
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.coupled_robots import random_coupled
from tests.support.euler_coordinates import difference, euler_acceleration
from tests.support.interpreter import commands_without_numba, python
from tests.support.robots import random_model, robot_of

SHIPPED = ("mini", "servicer", "panda_sat")
STATES = 100  # of each robot
PERIOD = 0.25


def random_tree(seed: int) -> Robot:
    """A tree of up to nine revolute and prismatic joints; every other one floats."""
    rng = np.random.default_rng(seed)
    return robot_of(random_model(rng, int(rng.integers(0, 10))), floating=seed % 2 == 0)


def random_coordinates(rng: np.random.Generator, n: int) -> tuple[Vector, ...]:
    """Coordinates away from the singularity, and three vectors of their size."""
    x = rng.uniform(-2.0, 2.0, 6 + n)
    x[4] = rng.uniform(-1.3, 1.3)
    return x, *rng.normal(size=(3, 6 + n))


def random_states(rng: np.random.Generator, n: int) -> tuple[RobotState, Reference]:
    """A state, and a reference of the same stamp somewhere else."""

    def configuration() -> Vector:
        rpy = rng.uniform((-3.0, -1.2, -3.0), (3.0, 1.2, 3.0))
        return np.array([*rng.normal(size=3), *from_rpy(rpy), *rng.uniform(-2.0, 2.0, n)])

    v, v_d, a_d = rng.normal(size=(3, 6 + n))
    state = RobotState(0, configuration(), v, rng.normal(size=n), rng.normal(size=3))
    return state, Reference(0, configuration(), v_d, a_d)


def off(found: Any, wanted: Any) -> float:
    """Largest difference over the largest number."""
    return float(np.abs(np.asarray(found) - wanted).max() / np.abs(wanted).max())


def check_regressor(robot: Robot, rng: np.random.Generator) -> None:
    """One random motion of a robot, with the base as it is and with the base left to fall freely."""
    regressor, size = Regressor(robot), 6 + robot.n
    pi = regressor.parameters * rng.uniform(0.8, 1.2, regressor.parameters.size)
    x, dx, dx_r, ddx_r = random_coordinates(rng, robot.n)
    rows, tree, at = np.full((size, pi.size), np.nan), tree_of(robot.model), places(robot.n, len(robot.mimics))
    slotine_li(tree, at, x, dx, dx_r, ddx_r, pi, False, rows)
    wanted = regressor.slotine_li(x, dx, dx_r, ddx_r)
    assert off(rows, wanted) < 1e-12
    slotine_li(tree, at, x, dx, dx_r, ddx_r, pi, True, rows)
    push = np.array([*(wanted[:3] @ pi / -pi[::10].sum()), *np.zeros(size - 3)])
    assert off(rows, wanted + regressor.inertia(x, push)) < 1e-12
    assert np.abs(rows[:3] @ pi).max() < 1e-12 * np.abs(wanted @ pi).max()


@pytest.mark.parametrize("name", SHIPPED)
def test_regressor_of_shipped_robots_is_pinocchios(name: str) -> None:
    """Y equals the polarised regressor of Pinocchio to 1e-12 in 100 random motions of each of three robots."""
    robot, rng = load_robot(name), np.random.default_rng(7)
    for _ in range(STATES):
        check_regressor(robot, rng)


@pytest.mark.parametrize("seed", range(60))
def test_regressor_of_any_tree_is_pinocchios(seed: int) -> None:
    """The same for random trees of revolute and prismatic joints."""
    check_regressor(random_tree(seed), np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(20))
def test_regressor_of_followers_is_that_of_the_reduced_equations(seed: int) -> None:
    """The same for trees of which joints follow others; Y pi is G^T of the forces of the model where none does."""
    rng = np.random.default_rng(seed)
    case = random_coupled(rng, int(rng.integers(2, 9)), serial=True)
    robot = robot_of(case.model, floating=True)
    check_regressor(robot, rng)
    regressor, free = Regressor(robot), Regressor(robot_of(case.full, floating=True))
    x, dx, ddx, _ = random_coordinates(rng, robot.n)
    full = np.concatenate([x[:6], case.G[6:, 6:] @ x[6:] + case.shift])
    wanted = case.G.T @ free.inverse_dynamics(full, case.G @ dx, case.G @ ddx)
    assert off(regressor.inverse_dynamics(x, dx, ddx), wanted) < 1e-12
    mass = case.G.T @ free.mass_matrix(full) @ case.G
    assert off(regressor.mass_matrix(x), mass) < 1e-12
    assert off(regressor.inertia(x, ddx) @ regressor.parameters, mass @ ddx) < 1e-11


def expected_control(
    cycle: Cycle, robot: Robot, pi: Vector, state: RobotState, wheels: Vector, reference: Reference
) -> tuple[Vector, Vector, float]:
    """Command, sigma with eliminated translation and Lyapunov function by equations over Pinocchio; no lead."""
    regressor, first, rule = Regressor(robot), cycle.rule.first, cycle.rule
    (x, dx), (x_d, dx_d) = euler_state(state), euler_state(reference)
    error, rate = difference(x_d, x)[first:], (dx_d - dx)[first:]
    dx_r, ddx_r = np.zeros((2, x.size))
    dx_r[first:], ddx_r[first:] = dx_d[first:], euler_acceleration(reference, x_d, dx_d)[first:]
    if rule.on_velocity:
        sigma = rule.lambda_ * rate + error
    else:
        sigma = rate + rule.lambda_ * error
        dx_r[first:] += rule.lambda_ * error
        ddx_r[first:] += rule.lambda_ * rate
    rows, sigma_full = regressor.slotine_li(x, dx, dx_r, ddx_r), np.zeros(x.size)
    sigma_full[first:] = sigma
    if first:
        mass, push = pi[::10].sum(), np.zeros(x.size)
        push[:3] = rows[:3] @ pi / -mass
        rows += regressor.inertia(x, push)
        sigma_full[:3] = (regressor.inertia(x, sigma_full) @ pi)[:3] / -mass
    force = rows @ pi
    force[first:] += rule.k_d @ sigma
    axes = np.array([about_axes(x, unit) for unit in np.eye(3)])  # omega = axes @ [yaw', pitch', roll']
    u = np.array([*force[:3], *np.linalg.solve(axes.T, force[3:6]), *force[6:]])
    u[:3] = 0.0 if first else rotate_inverse(from_rpy((x[5], x[4], x[3])), force[:3])
    u[3:6] += np.cross(state.v[3:6], wheels)
    energy = sigma_full @ (regressor.inertia(x, sigma_full) @ pi)
    return u, sigma_full, 0.5 * energy + (rule.lambda_ * error) @ rule.k_d @ error


@pytest.mark.parametrize("lambda_on", ["position", "velocity"])
@pytest.mark.parametrize("name", SHIPPED)
def test_command_is_that_of_the_equations_over_pinocchio(name: str, lambda_on: str) -> None:
    """u, sigma with eliminated translation and the Lyapunov function agree to 1e-12 in 20 random states each."""
    robot, rng = load_robot(name), np.random.default_rng(8)
    gains = Adaptive.Gains.model_validate({"update": "none", "lambda": 0.7, "lambda_on": lambda_on})
    cycle, parameters = Cycle(robot, gains, PERIOD), Regressor(robot).parameters
    size = 6 + robot.n - cycle.rule.first
    for _ in range(20):
        root = rng.normal(size=(size, size))
        cycle.rule.k_d[:] = root @ root.T
        pi = parameters * rng.uniform(0.8, 1.2, parameters.size)
        (state, reference), wheels = random_states(rng, robot.n), rng.normal(size=3)
        u, value = cycle.control(pi, *euler_state(state), state.v[3:6], wheels, reference)
        wanted_u, wanted_sigma, wanted_value = expected_control(cycle, robot, pi, state, wheels, reference)
        assert off(u, wanted_u) < 1e-12
        assert off(cycle.workspace.sigma_full, wanted_sigma) < 1e-12
        assert value == pytest.approx(wanted_value, rel=1e-12)


@pytest.mark.parametrize("source", ["model", "accelerometer", "velocity"])
@pytest.mark.parametrize("name", ["mini", "servicer"])
def test_regression_is_that_of_the_equations_over_pinocchio(name: str, source: str) -> None:
    """Regressor and generalised force in the middle of a period agree to 1e-12, free-floating and free-flying."""
    robot, rng = load_robot(name), np.random.default_rng(9)
    rls = {"translation": source, "torque_noise": 0.02, "force_noise": 0.3}
    cycle = Cycle(robot, Adaptive.Gains.model_validate({"rls": rls}), PERIOD)
    regressor, first = Regressor(robot), cycle.rule.first
    pi = np.array(regressor.parameters)
    for _ in range(20):
        (start, _), (end, _), (wrench, wheels) = (
            random_states(rng, robot.n),
            random_states(rng, robot.n),
            rng.normal(size=(2, 6)),
        )
        (x0, dx0), (x1, dx1) = euler_state(start), euler_state(end)
        period = PeriodStart(x0, dx0, start.v[3:6], wheels[:3], wrench)
        rows, values = cycle.regression(pi, period, x1, dx1, end)
        x, dx, ddx = x0 + 0.5 * difference(x1, x0), 0.5 * (dx0 + dx1), (dx1 - dx0) / PERIOD
        if first:
            ddx[:3] = {"model": np.zeros(3), "velocity": ddx[:3]}.get(source, rotate(end.q[3:7], end.base_acceleration))
        wanted = regressor.inverse_dynamics(x, dx, ddx)
        if first and source == "model":
            push = np.array([*(wanted[:3] @ pi / -pi[::10].sum()), *np.zeros(x.size - 3)])
            wanted += regressor.inertia(x, push)
        torque = wrench[3:] - np.cross(0.5 * (start.v[3:6] + end.v[3:6]), wheels[:3])
        turn = from_rpy((x[5], x[4], x[3]))
        applied = [*rotate(turn, wrench[:3]), *about_axes(x, torque), *end.effort]
        assert off(rows, wanted[first:] / cycle.rule.noise[:, None]) < 1e-12
        assert off(values, np.array(applied)[first:] / cycle.rule.noise) < 1e-12


def about_axes(x: Vector, torque: Vector) -> Vector:
    """The part of a body torque along the axes that yaw, pitch and roll turn about."""
    turn = from_rpy((x[5], x[4], x[3]))
    yaw, pitch = (0.0, 0.0, 1.0), (-np.sin(x[3]), np.cos(x[3]), 0.0)
    return np.array([np.dot(rotate_inverse(turn, yaw), torque), np.dot(rotate_inverse(turn, pitch), torque), torque[0]])


def test_covariance_times_a_direction_needs_no_covariance() -> None:
    """G d without forming G."""
    rng = np.random.default_rng(10)
    root, direction, out = rng.normal(size=(30, 30)), rng.normal(size=30), np.empty(30)
    covariance_times(root, direction, np.empty(30), out)
    assert off(out, root @ root.T @ direction) < 1e-13


def test_an_estimate_is_assessed_by_all_its_numbers() -> None:
    """One infinite or missing number is found wherever it stands; the mass is the sum of all bodies."""
    good = np.array(Regressor(load_robot("mini")).parameters)
    finite, mass, possible = assess(good)
    assert (finite, possible) == (True, True)
    assert mass == pytest.approx(36.4, rel=1e-15)
    for k in range(good.size):
        for lost in (np.nan, np.inf, -np.inf):
            bad = np.array(good)
            bad[k] = lost
            assert assess(bad)[0] is False


@pytest.mark.skipif(not jit.COMPILED, reason="numba is not installed")
def test_cache_watches_every_source_of_the_cycle() -> None:
    """The cached machine code is tied to the law's kernel folder and to the one shared with the plant."""
    compiled: Any = control
    assert compiled._cache._cache_file._source_stamp == jit.digest(compiled.py_func)
    assert jit.digest(compiled.py_func) != jit.digest(jit.kernel)


def test_the_compilation_notice_names_plant_and_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """The notice names plant and law where they are to be compiled, and says nothing of what is ready."""
    for plant, law, said in (
        (False, False, ""),
        (True, False, "compiling the plant, once (about 20 s)"),
        (False, True, "compiling the law adaptive, once (about 15 s)"),
        (True, True, "compiling the plant and the law adaptive, once (about 35 s)"),
    ):
        monkeypatch.setattr(compiling, "plant_must_compile", lambda plant=plant: plant)
        monkeypatch.setattr(Adaptive, "must_compile", lambda law=law: law)
        assert compiling.notice(["adaptive", "computed_torque", "adaptive"]) == said
    assert compiling.notice(["no such law"], plant=False) == ""
    assert not ComputedTorque.must_compile()


OTHER_LAW = """
import sys
from space_robot_control.laws import make_law
from space_robot_description.load import load_robot

make_law("computed_torque", load_robot("mini"), 0.25)
laws = "space_robot_control.laws"
print(*sorted({f"{laws}.adaptive.kernel.control", f"{laws}.ntsmc.kernel.sliding"} & set(sys.modules)))
"""


def test_another_law_neither_compiles_nor_loads_this_one() -> None:
    """Making a computed-torque law loads no kernel of another law."""
    assert python(OTHER_LAW).split() == []


def commands() -> list[float]:
    """Commands and estimates of a few cycles of the law with everything switched on, slow to follow the states."""
    robot, rng = load_robot("mini"), np.random.default_rng(11)
    gains = {"update": "composite", "lead": True, "rls": {"torque_noise": 1.0}, "tracking": {"gain": 10.0}}
    law = Adaptive(robot, PERIOD, Adaptive.Gains.model_validate(gains))
    found: list[float] = []
    for k in range(4):
        q = np.array([0, 0, 0, *from_rpy(0.02 * rng.normal(size=3)), *(robot.home + 0.02 * rng.normal(size=robot.n))])
        v, v_d, a_d = 0.01 * rng.normal(size=(3, 6 + robot.n))
        state = RobotState(k, q, v, 0.01 * rng.normal(size=robot.n), np.zeros(3))
        output = law.update(state, Reference(k, q, v_d, a_d))
        found += [*output.command.u.tolist(), *output.telemetry.data.tolist()]
    return found


def test_runs_without_numba() -> None:
    """The same text uncompiled gives the same commands, estimates and covariance to 1e-12, without a warning."""
    np.testing.assert_allclose(commands_without_numba(__name__), commands(), rtol=1e-12, atol=1e-12)


def test_the_compilation_notice_of_a_study_names_what_runs_many(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a law can run side by side with others; not of a single run, nor where it is ready."""
    monkeypatch.setattr(compiling, "plant_must_compile", lambda: False)
    monkeypatch.setattr(Adaptive, "must_compile", lambda: False)
    monkeypatch.setattr(compiling, "cached", lambda source, function: False)
    assert compiling.LANES.is_file()
    assert compiling.notice(["adaptive"], many=True) == "compiling side-by-side runs, once (about 15 s)"
    assert compiling.notice(["adaptive"]) == compiling.notice(["none", "no such law"], many=True) == ""
    monkeypatch.setattr(compiling, "cached", lambda source, function: True)
    assert compiling.notice(["adaptive"], many=True) == ""
