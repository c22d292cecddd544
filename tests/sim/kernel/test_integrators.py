"""Order, tolerance and analytic truths of the integrators."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations_with_replacement
from math import prod
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_msgs_py.errors import IntegrationError, SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.kernel.steps import STEP_BOUND
from space_robot_sim.kernel.tableau import ERROR_3, ERROR_5, A, B, C
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import MAX_STEPS, IntegratorSpec
from tests.support.robots import arm_model, random_model, random_state, robot_of

SECOND = 1_000_000_000
Tree = tuple["Tree", ...]


def _trees(order: int) -> list[Tree]:
    """Rooted trees with that many nodes."""
    return [tuple(sorted(children)) for children in _forests(order - 1, order - 1)] if order > 1 else [()]


def _forests(nodes: int, largest: int) -> Iterator[list[Tree]]:
    if nodes == 0:
        yield []
        return
    for size in range(min(nodes, largest), 0, -1):
        for count in range(nodes // size, 0, -1):
            for same in combinations_with_replacement(_trees(size), count):
                for rest in _forests(nodes - size * count, size - 1):
                    yield [*same, *rest]


def _nodes(tree: Tree) -> int:
    return 1 + sum(map(_nodes, tree))


def _density(tree: Tree) -> int:
    return _nodes(tree) * prod(map(_density, tree))


def _weight(tree: Tree) -> np.ndarray:
    """Stage-wise elementary weight of a tree."""
    return np.prod([A @ _weight(child) for child in tree], axis=0) if tree else np.ones(len(C))


def _defect(weights: np.ndarray, order: int) -> float:
    """Largest violation of the order conditions of exactly that order."""
    return max(abs(float(weights @ _weight(tree)) - 1.0 / _density(tree)) for tree in _trees(order))


def test_dop853_meets_its_order_conditions() -> None:
    """All 200 order conditions up to order 8 hold; the embedded results are of order 5 and 3, and no more."""
    assert [len(_trees(order)) for order in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]
    np.testing.assert_allclose(A.sum(axis=1), C, atol=1e-14)
    assert max(_defect(B, order) for order in range(1, 9)) < 1e-13
    assert _defect(B, 9) > 1e-8
    for error, order in ((ERROR_5, 5), (ERROR_3, 3)):
        assert max(_defect(B - error, lower) for lower in range(1, order + 1)) < 1e-13
        assert _defect(B - error, order + 1) > 1e-6


def _advance_kernel(spec: IntegratorSpec, *, period: int, periods: int) -> np.ndarray:
    """The configuration of a lively robot after some seconds under held efforts."""
    robot = robot_of(random_model(np.random.default_rng(5), 4, serial=True, kinds=("RX", "RY", "RZ")))
    initial = InitialState(*random_state(np.random.default_rng(2), 4, 0.3))
    plant = SimulatedRobot(robot, control_period=period, initial=initial, integrator=spec)
    command = Command(0, [1.0, -2.0, 0.5, 0.3, 0.2, -0.4], [0.4, -0.3, 0.2, 0.1])
    for _ in range(periods):
        sample = plant.step(command)
    return sample.state.q


@pytest.mark.parametrize(("kind", "order", "steps"), [("rk4", 4, (0.05, 0.025)), ("dop853", 8, (0.5, 0.25))])
def test_order_of_convergence(kind: str, order: int, steps: tuple[float, float]) -> None:
    """Halving the step divides the error by 2^order."""
    exact = _advance_kernel(IntegratorSpec(kind="dop853", step=0.02), period=SECOND // 2, periods=6)
    coarse, fine = (
        np.abs(_advance_kernel(IntegratorSpec(kind=kind, step=step), period=SECOND // 2, periods=6) - exact).max()
        for step in steps
    )
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.6)


def test_adaptive_steps_keep_their_tolerance() -> None:
    """The adaptive result is as good as its tolerance asks, and a tighter one is better."""
    exact = _advance_kernel(IntegratorSpec(kind="dop853", step=0.02), period=SECOND // 2, periods=6)
    loose, tight = (
        np.abs(
            _advance_kernel(IntegratorSpec(kind="dop853_adaptive", rtol=tol, atol=tol), period=SECOND // 2, periods=6)
            - exact
        )
        for tol in (1e-5, 1e-10)
    )
    assert loose.max() < 1e-3
    assert tight.max() < min(1e-8, 0.01 * loose.max())


@pytest.mark.parametrize("kind", ["dop853", "dop853_adaptive", "rk4"])
def test_the_fallback_equals_the_kernel(kind: str) -> None:
    """Over a run the steps over pinocchio and the compiled ones agree to 1e-12."""
    first, second = (
        _advance_kernel(IntegratorSpec(kind=kind, kernel=kernel), period=SECOND // 10, periods=20)
        for kernel in ("auto", "pinocchio")
    )
    np.testing.assert_allclose(first, second, rtol=0.0, atol=1e-12)


def _coasted(rate: float, **spec: Any) -> Vector:
    """(14,) configuration after 2 s of an arm that coasts with rates of that size."""
    return _coast(rate, **spec).state.q


def _coast(rate: float, **spec: Any) -> PlantSample:
    q, v = random_state(np.random.default_rng(0), 7, 0.05)
    moving = np.concatenate([v[:6], rate * np.sin(np.arange(7.0))])
    plant = SimulatedRobot(
        robot_of(arm_model(), floating=True),
        control_period=SECOND // 10,
        initial=InitialState(q, moving),
        integrator=IntegratorSpec.model_validate(spec),
    )
    return [plant.reset(), *(plant.step(None) for _ in range(20))][-1]


@pytest.mark.parametrize("kernel", ["numba", "pinocchio"])
def test_fast_motion_is_integrated_in_shorter_steps(kernel: str) -> None:
    """Where 50 ms are 3e-4 off at several rad/s, `auto` is within 1e-6: the error of the steps is bounded."""
    exact = _coasted(2.0, kind="dop853", step=5e-4)
    assert np.abs(_coasted(2.0, kind="dop853", kernel=kernel) - exact).max() > 1e-4
    assert np.abs(_coasted(2.0, kernel=kernel) - exact).max() < 1e-6


@pytest.mark.parametrize("kernel", ["numba", "pinocchio"])
@pytest.mark.parametrize("rate", [1.0, 1.5, 2.0])
def test_the_integration_error_is_estimated(rate: float, kernel: str) -> None:
    """The sum of the estimates is at least a tenth of the true error of fixed steps, and at most 100 times that."""
    exact, found = _coasted(rate, kind="dop853", step=5e-4), _coast(rate, kind="dop853", kernel=kernel)
    error, estimate = np.abs(found.state.q - exact).max(), found.telemetry["integration_error"][0]
    assert 0.1 * error < estimate < 100.0 * error


def test_steps_without_an_estimate_show_none() -> None:
    """Runge and Kutta's fourth order has no embedded estimate, so there is no block that says 0."""
    assert "integration_error" not in _coast(0.2, kind="rk4").telemetry.labels


@pytest.mark.parametrize("kernel", ["numba", "pinocchio"])
def test_slow_motion_has_the_bits_of_fixed_steps(kernel: str) -> None:
    """No step misses the tolerance: `auto` is `dop853` to the bit."""
    slow = _coasted(0.2, kernel=kernel)
    assert slow.tobytes() == _coasted(0.2, kind="dop853", kernel=kernel).tobytes()


def test_symmetric_top() -> None:
    """A torque-free symmetric body turns and precesses as Euler's closed solution says."""
    model = random_model(np.random.default_rng(0), 0)
    model.inertias[1] = pin.Inertia(10.0, np.zeros(3), np.diag([2.0, 2.0, 3.0]))
    q, omega, time = np.array([0.0, 0, 0, 0, 0, 0, 1]), np.array([0.2, -0.1, 0.4]), 20.0
    plant = SimulatedRobot(robot_of(model), control_period=SECOND // 10, initial=InitialState(q, [0, 0, 0, *omega]))
    for _ in range(200):
        sample = plant.step(None)
    # omega_body = L_body / A + (1 - C/A) omega_z z, with L constant in the inertial frame.
    precession = pin.exp3(np.array([0.4, -0.2, 1.2]) * time / 2.0)
    expected = precession @ pin.exp3(np.array([0.0, 0.0, (1.0 - 1.5) * 0.4 * time]))
    np.testing.assert_allclose(pin.Quaternion(np.array(sample.state.q[3:7])).matrix(), expected, atol=1e-12)


def test_period_that_does_not_divide_is_refused() -> None:
    """A period that is no whole number of nanoseconds per step is refused with both numbers."""
    robot = robot_of(arm_model())
    initial = InitialState(*random_state(np.random.default_rng(0), 7))
    with pytest.raises(SpecError, match=r"100000000 ns does not divide into 3 equal steps.*0.04"):
        SimulatedRobot(robot, control_period=SECOND // 10, initial=initial, integrator=IntegratorSpec(step=0.04))


def test_fixed_and_adaptive_steps_have_one_bound() -> None:
    """What a file may ask for in fixed steps is what the kernel allows in adaptive ones."""
    assert MAX_STEPS == STEP_BOUND


def test_tolerance_that_cannot_be_kept_is_an_error() -> None:
    """Adaptive steps end with an error and the time instead of running forever."""
    robot = robot_of(arm_model(), {"joints": {"effort": 1e6, "coulomb": 1e4, "coulomb_velocity": 1e-9}})
    initial = InitialState(*random_state(np.random.default_rng(0), 7))
    plant = SimulatedRobot(robot, control_period=SECOND // 10, initial=initial)
    with pytest.raises(IntegrationError, match=r"tolerance cannot be kept between 0 s and 0.1 s"):
        plant.step(None)
