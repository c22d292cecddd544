"""What the proof of the Lyapunov update holds for, and what stays of it on a free-floating base."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Vector

STEP = 1e-5


def eliminated(matrix: Vector, sigma: Vector) -> Vector:
    """[sigma_p, sigma] with sigma_p = -M_pr sigma / m of a mass matrix."""
    return np.concatenate([-matrix[:3, 3:] @ sigma / matrix[0, 0], sigma])


def kinetic(regressor: Regressor, x: Vector, sigma: Vector) -> float:
    """sigma^T M_red sigma / 2."""
    return 0.5 * float(sigma @ regressor.reduced_mass_matrix(x) @ sigma)


def terms(truth: Regressor, belief: Regressor, rng: np.random.Generator) -> tuple[float, float, float]:
    """What is left of the derivative of (42) beside -sigma^T K_D sigma at a random state of a floating robot.

    Returns:
        With sigma_p of the true robot in (44), with that of the estimate, and (s_p - s_p_hat)^T Y_p pi.
    """
    n, pi, estimate = truth.n, truth.parameters, belief.parameters
    x = np.concatenate([np.zeros(3), rng.uniform(-1.0, 1.0, 3 + n)])
    dx, dx_r, ddx_r = (np.concatenate([np.zeros(3), rng.normal(size=3 + n)]) for _ in range(3))
    # The zero-force rows of the estimate give the translation: Y_p pi_hat = 0.
    ddx_r[:3] = -(truth.slotine_li(x, dx, dx_r, ddx_r) @ estimate)[:3] / belief.mass_matrix(x)[0, 0]
    Y, sigma = truth.slotine_li(x, dx, dx_r, ddx_r), (dx_r - dx)[3:]
    damping = np.concatenate([np.zeros(3), belief.reduced_mass_matrix(x) @ sigma])
    matrix = truth.mass_matrix(x)
    ddx = np.linalg.solve(matrix, Y @ estimate + damping - truth.inverse_dynamics(x, dx, np.zeros(6 + n)) @ pi)
    rate = (ddx_r - ddx)[3:]
    ahead, behind = (kinetic(truth, x + h * dx, sigma + h * rate) for h in (STEP, -STEP))
    slope = (ahead - behind) / (2.0 * STEP) + float(sigma @ damping[3:])
    true, estimated = eliminated(matrix, sigma), eliminated(belief.mass_matrix(x), sigma)
    off = Y @ (pi - estimate)
    return slope - float(true @ off), slope - float(estimated @ off), float((true - estimated)[:3] @ (Y @ pi)[:3])


def test_the_proof_of_the_lyapunov_update_is_exact_with_the_true_translation_alone() -> None:
    """With sigma_p = -M_pr sigma / m of the true robot all but -sigma^T K_D sigma cancels; with M_hat it does not."""
    robot, rng = load_robot("mini"), np.random.default_rng(0)
    model = robot.model.copy()
    for index in range(1, model.njoints):
        model.inertias[index].mass *= 1.0 + 0.2 * rng.uniform(-1.0, 1.0)
    truth, belief = Regressor(robot), Regressor(replace(robot, model=model))
    rows = np.array([terms(truth, belief, rng) for _ in range(30)])
    scale = np.abs(rows[:, 1]).max()
    assert np.abs(rows[:, 0]).max() < 1e-4 * scale
    np.testing.assert_allclose(rows[:, 1], rows[:, 2], atol=1e-4 * scale)
    assert rows[:, 2].min() < -0.1 * scale
    assert rows[:, 2].max() > 0.1 * scale
