"""What cannot be judged is said in the project's own words, whatever stands in the ticks."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.judge.judging import Judge
from space_robot_bringup.judge.measure import tick_blocks
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_msgs_py.errors import LayoutError


@pytest.fixture(scope="module")
def composition() -> Composition:
    """Two seconds of fig08."""
    return compose(load_experiment("liu2023/fig08", ("duration=2.0",)))


@pytest.mark.parametrize("part", ["q_d", "v_d", "true_configuration", "saturation", "applied_wrench", "applied_effort"])
def test_ticks_of_another_robot_are_one_error(composition: Composition, part: str) -> None:
    """A desired state or telemetry of another size, as a damaged log may have it, is refused when the run is judged."""
    ((stamps, plant, q_d, v_d),) = tick_blocks(run_in_memory(composition).ticks)
    short = {"q_d": q_d, "v_d": v_d, **plant}
    short[part] = np.zeros((len(stamps), 0))
    judging = Judge(composition)
    judging.add((stamps, {name: short[name] for name in plant}, short["q_d"], short["v_d"]))
    with pytest.raises(LayoutError, match="of another robot"):
        judging.verdict("completed")
