"""The nominal model against Pinocchio's forward dynamics and a general linear solve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.nominal_model import NominalModel
from space_robot_msgs_py.errors import ControlError, SpecError
from tests.support.robots import random_inertia, random_model, random_state, robot_of

SEEDS = range(10)


def case(seed: int, floating: bool = False) -> tuple[NominalModel, np.ndarray, np.ndarray, np.ndarray]:
    """A random tree with up to eight joints, its state and an acceleration."""
    rng = np.random.default_rng(seed)
    n = 1 + seed % 8
    q, v = random_state(rng, n)
    return NominalModel(robot_of(branched_model(rng, n), floating=floating)), q, v, rng.normal(size=6 + n)


def branched_model(rng: np.random.Generator, joints: int) -> Any:
    """Two random chains on one base, numbered depth first as Pinocchio's mass matrix needs it and URDF gives it."""
    first = joints // 2
    model = random_model(rng, first, serial=True)
    last = 1
    for index in range(first, joints):
        axis = rng.normal(size=3)
        joint = pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis))
        last = model.addJoint(last, joint, pin.exp6(rng.normal(size=6)), f"joint_{index}")
        model.appendBodyToJoint(last, random_inertia(rng, 3.0, 0.2), pin.SE3.Identity())
    return model


@pytest.mark.parametrize("seed", SEEDS)
def test_inverse_dynamics_inverts_forward_dynamics(seed: int) -> None:
    """aba(q, v, M a + c) = a."""
    model, q, v, a = case(seed)
    u = model.inverse_dynamics(q, v, a)
    free = model.robot.model
    np.testing.assert_allclose(pin.aba(free, free.createData(), q, v, u), a, atol=1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_mass_matrix_and_bias_make_up_the_inverse_dynamics(seed: int) -> None:
    """M(q) is symmetric and positive definite, holds the mass on its translation block, and M a + c = u."""
    model, q, v, a = case(seed)
    m = model.mass_matrix(q)
    assert (m == m.T).all()
    assert np.linalg.eigvalsh(m).min() > 0.0
    np.testing.assert_allclose(m[:3, :3], model.mass * np.eye(3), atol=1e-11)
    np.testing.assert_allclose(m @ a + model.bias(q, v), model.inverse_dynamics(q, v, a), atol=1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_free_floating_base_translates_as_zero_force_demands(seed: int) -> None:
    """The linear acceleration solves the three zero-force rows; the rest of the wish is kept bit for bit."""
    model, q, v, a = case(seed, floating=True)
    out = model.free_floating_acceleration(q, v, a)
    m, c = model.mass_matrix(q), model.bias(q, v)
    np.testing.assert_allclose(out[:3], np.linalg.solve(m[:3, :3], -m[:3, 3:] @ a[3:] - c[:3]), atol=1e-11)
    assert (out[3:] == a[3:]).all()
    u = model.reduced_mass_matrix(q) @ a[3:] + (c[3:] - m[3:, :3] @ c[:3] / model.mass)
    np.testing.assert_allclose(u, model.actuated_inverse_dynamics(q, v, a)[0][3:], atol=1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_free_floating_command_has_no_force_and_does_what_it_says(seed: int) -> None:
    """The force is exactly zero and forward dynamics return the promised acceleration."""
    model, q, v, a = case(seed, floating=True)
    u, promised = model.actuated_inverse_dynamics(q, v, a)
    assert (u[:3] == 0.0).all()
    free = model.robot.model
    np.testing.assert_allclose(pin.aba(free, free.createData(), q, v, u), promised, atol=1e-10)


def test_results_stay_when_the_model_is_asked_again() -> None:
    """Returned arrays are the caller's: later calls on the same work space do not change them."""
    model, q, v, a = case(3)
    results = [model.mass_matrix(q), model.bias(q, v), model.inverse_dynamics(q, v, a)]
    copies = [result.copy() for result in results]
    _, q, v, a = case(11)
    model.mass_matrix(q), model.bias(q, v), model.inverse_dynamics(q, v, a)
    for result, copy in zip(results, copies, strict=True):
        assert (result == copy).all()


def test_numbers_beyond_all_bounds_are_an_error() -> None:
    """An acceleration that overflows ends in ControlError, not in a command."""
    model, q, v, a = case(2)
    with pytest.raises(ControlError, match="not finite"):
        model.inverse_dynamics(q, v * 1e200, a)


def test_a_model_that_is_no_free_flyer_is_refused() -> None:
    """A fixed base or gravity in the model is one clear error."""
    robot = robot_of(random_model(np.random.default_rng(0), 2))
    fixed = pin.Model()
    fixed.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "only")
    with pytest.raises(SpecError, match="not a free-flying robot"):
        NominalModel(replace(robot, model=fixed))
    robot.model.gravity.linear = np.array([0.0, 0.0, -9.81])
    with pytest.raises(SpecError, match="no gravity"):
        NominalModel(robot)
