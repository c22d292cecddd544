"""What every run of a manifest needs."""

from __future__ import annotations

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """The plant is compiled before: the first use says so in a line of its own."""
    compose(load_experiment("liu2023/fig08")).plant()
