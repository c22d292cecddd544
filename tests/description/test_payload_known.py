"""A captured load of which the flight software knows a fraction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_description.inertia import inertial_parameters

LOAD = {"mass": 50.1, "com": [0.1, 0.0, 0.2], "inertia": [100, 100, 100, 5, 5, 5]}


def composed(plant: dict[str, Any], nominal: dict[str, Any]) -> Any:
    base = {"robot": "servicer", "control_period": 0.1, "duration": 1.0, "reference": {"kind": "hold"}}
    return compose(experiment_from({**base, "plant": plant, "nominal": nominal}, "test"))


@pytest.mark.parametrize("known", [0.0, 0.3, 1.0])
def test_the_nominal_robot_carries_the_known_fraction(known: float) -> None:
    """Nominal parameters lie on the line from the empty to the loaded robot; the truth carries all of it."""
    empty, loaded = composed({}, {}).truth, composed({"payload": LOAD}, {}).truth
    composition = composed({"payload": LOAD}, {"payload_known": known})
    parameters = [inertial_parameters(robot) for robot in (empty, loaded, composition.nominal)]
    np.testing.assert_allclose(parameters[2], (1 - known) * parameters[0] + known * parameters[1], atol=1e-9)
    assert (inertial_parameters(composition.truth) == parameters[1]).all()


@pytest.mark.parametrize(
    ("plant", "nominal", "says"),
    [
        ({}, {"payload_known": 0.5}, "nominal.payload_known: there is no payload"),
        ({"payload": LOAD}, {"payload_known": 0.5, "payload": LOAD}, "payload or payload_known, not both"),
        ({"payload": LOAD}, {"payload_known": 1.5}, "nominal.payload_known: .*less than or equal to 1"),
        ({"payload": LOAD, "payload_known": 0.5}, {}, "plant.payload_known: unknown key"),
        ({"payload": {"mass": 0.1, "inertia": [50, 60, 150]}}, {"payload_known": 0.5}, "triangle inequality"),
    ],
)
def test_a_fraction_of_nothing_and_impossible_loads_are_refused(
    plant: dict[str, Any], nominal: dict[str, Any], says: str
) -> None:
    """One clear error each; a draw of the paper that cannot exist is refused as any such body."""
    with pytest.raises(ValueError, match=says):
        composed(plant, nominal)
