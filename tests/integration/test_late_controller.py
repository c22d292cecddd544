"""Paced, beside a busy core: whenever the controller appears, every command that acted is in the log."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.processes import run_processes
from tests.support.busy import burning_core
from tests.support.late import ENOUGH, OVERRIDES, Enough, tally

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


# How often it holds, `python -m tests.chaos.late` counts.
@pytest.mark.parametrize(
    ("realtime", "late"),
    [
        (20.0, 1.5),
        *(pytest.param(4.0, late, marks=pytest.mark.thorough) for late in (1.5, 5.0, 20.0)),
        *(pytest.param(20.0, late, marks=pytest.mark.thorough) for late in (5.0, 20.0)),
    ],
)
def test_nothing_that_acted_is_missing_in_the_log(realtime: float, late: float, tmp_path: Path) -> None:
    """The others start first, the controller so many seconds later; plant and controller replay equal from that log."""
    place = tmp_path / "run"
    composition, hooks = compose(load_experiment("liu2023/fig08", OVERRIDES)), Hooks(stop=Enough(place))
    with burning_core():
        reason = run_processes(composition, place, realtime=realtime, hooks=hooks, late={"controller": late})
    assert reason == "enough"
    found = tally(place)
    assert found.acted > ENOUGH
    assert (found.gaps, found.missing, found.equal) == (0, 0, {"controller": True, "plant": True})
