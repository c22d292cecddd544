"""Joints that follow others: the kernels against G^T M G and G^T c of the model in which every joint is free."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_description.kernel.arrays import locked_joints, robot_arrays, with_locked_joints
from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE, inverse_dynamics
from space_robot_sim.kernel.articulated import WORKSPACE
from space_robot_sim.kernel.coupled import coupled_dynamics, coupled_memory
from space_robot_sim.kernel.momentum import balance
from tests.support.coupled_robots import Coupled, random_coupled
from tests.support.robots import random_state

Case = tuple[Coupled, np.random.Generator, int, np.ndarray, np.ndarray]


def _case(seed: int) -> Case:
    rng = np.random.default_rng(seed)
    case = random_coupled(rng, int(rng.integers(2, 12)), serial=seed % 2 == 0)
    n = case.model.nv - 6
    return case, rng, n, *random_state(rng, n)


@pytest.mark.parametrize("seed", range(40))
def test_forward_dynamics_of_followers_equals_the_reduced_model(seed: int) -> None:
    """Accelerations solve G^T M G a = u - G^T c to 1e-12, also with a coordinate that a brake holds."""
    case, rng, n, q, v = _case(seed)
    u, held = rng.normal(size=6 + n) * 5.0, np.zeros(n)
    if seed % 4 == 0:
        held[rng.integers(n)] = 1
        v[6:][held > 0] = 0.0
    y = np.concatenate([q, v])
    robot, dy = with_locked_joints(robot_arrays(case.model), held), np.zeros_like(y)
    np.testing.assert_array_equal(locked_joints(robot), held > 0)
    memory = coupled_memory(n, case.full.nv - case.model.nv)
    coupled_dynamics(robot, y, tuple(u[:3].tolist()), tuple(u[3:6].tolist()), u[6:], memory, dy)
    free = np.r_[np.ones(6, dtype=bool), held == 0]
    expected = np.zeros(6 + n)
    right = (u - case.forces(q, v, np.zeros(6 + n)))[free]
    expected[free] = np.linalg.solve(case.mass_matrix(q)[np.ix_(free, free)], right)
    np.testing.assert_allclose(dy[7 + n :], expected, rtol=0.0, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("seed", range(20))
def test_inverse_dynamics_of_followers_equals_the_reduced_model(seed: int) -> None:
    """The nominal model's forces are G^T M_N G a + G^T c_N to 1e-12."""
    case, rng, n, q, v = _case(seed)
    a, out = rng.normal(size=6 + n), np.zeros(6 + n)
    inverse_dynamics(robot_arrays(case.model), q, v, a, np.zeros((case.full.nv - 5, MOTION_SIZE)), out)
    expected = case.forces(q, v, a)
    np.testing.assert_allclose(out, expected, rtol=0.0, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("seed", range(10))
def test_balance_of_followers_equals_that_of_the_free_model(seed: int) -> None:
    """Momentum and energy count the bodies of followers at the rates they have."""
    case, _, _, q, v = _case(seed)
    found, expected, no_wheels = np.zeros(9), np.zeros(9), (np.zeros((3, 0)), np.zeros(0))
    y, full = np.concatenate([q, v]), np.concatenate([case.joints(q), case.G @ v])
    work = np.zeros((case.full.nv - 5, WORKSPACE))
    balance(robot_arrays(case.model), y, *no_wheels, work, found)
    balance(robot_arrays(case.full), full, *no_wheels, work, expected)
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-11)
