"""Bodies that can exist: the nearest one, and steps that never leave them."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.adaptive.consistency import is_consistent, natural_step, project, pseudo_inertias
from space_robot_description import inertia
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot

PARAMETERS = inertial_parameters(load_robot("mini")).ravel()
SEEDS = range(20)


@pytest.mark.parametrize("seed", SEEDS)
def test_projection_gives_bodies_that_can_exist_and_the_nearest(seed: int) -> None:
    """Consistent, the same when done twice, and no nearer than any consistent body on the way back."""
    rng = np.random.default_rng(seed)
    wild = PARAMETERS * (1.0 + rng.normal(size=PARAMETERS.size))
    found = project(wild)
    assert not is_consistent(wild)
    assert is_consistent(found)
    assert all(inertia.is_consistent(body) for body in found.reshape(-1, 10))
    assert np.abs(project(found) - found).max() < 1e-12
    distance = np.linalg.norm(pseudo_inertias(found) - pseudo_inertias(wild))
    assert distance <= np.linalg.norm(pseudo_inertias(PARAMETERS) - pseudo_inertias(wild))


def test_projection_leaves_what_can_exist_alone() -> None:
    """Bodies that can exist keep their bits, also beside one that cannot."""
    assert project(PARAMETERS) is PARAMETERS
    mixed = PARAMETERS.copy()
    mixed[0] = -1.0
    assert (project(mixed)[10:] == PARAMETERS[10:]).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_natural_steps_stay_consistent_and_go_downhill(seed: int) -> None:
    """Along any gradient of any size the bodies stay possible, and a short step has a positive product with it."""
    gradient = np.random.default_rng(seed).normal(size=PARAMETERS.size)
    assert is_consistent(natural_step(PARAMETERS, gradient, 1e6))
    step = natural_step(PARAMETERS, gradient, 1e-6) - PARAMETERS
    assert step @ gradient > 0.0
    assert np.abs(natural_step(PARAMETERS, np.zeros(PARAMETERS.size), 1.0) - PARAMETERS).max() < 1e-13
