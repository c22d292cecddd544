"""Arrays of models that were seen before are those of the model as it is now."""

from __future__ import annotations

import numpy as np

from space_robot_description.kernel.arrays import robot_arrays
from space_robot_description.known_arrays import MAX_KNOWN, arrays_of
from tests.support.robots import random_model


def test_arrays_of_a_model_are_its_own_whatever_was_seen_before() -> None:
    """Again, with other motors, after others, after a change of the model, and after a change of what was returned."""
    rng = np.random.default_rng(3)
    models = [random_model(rng, 1 + k % 3) for k in range(2 * MAX_KNOWN)]
    for model in [*models, *models, models[0], models[0]]:
        motors = rng.uniform(0.1, 1.0, (model.nv - 6, 4))
        for given in (None, motors):
            for mine, wanted in zip(arrays_of(model, given), robot_arrays(model, given), strict=True):
                assert (mine.tobytes(), mine.shape, mine.dtype) == (wanted.tobytes(), wanted.shape, wanted.dtype)
                mine[...] = 0
        inertia = model.inertias[1]
        inertia.mass = 1.5 * inertia.mass
        model.inertias[1] = inertia
