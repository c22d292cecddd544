"""A slice of ``make chaos``: a process of a paced run is killed or stopped, and the response is as stated."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from tests.chaos.blows import Blow, faults, strike

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize(
    "blow",
    [
        Blow("controller", "kill", 0.3, None),
        Blow("guidance", "stop", 0.1, None),
        pytest.param(Blow("standby", "stop", 0.1, 1.0), marks=pytest.mark.thorough),
        pytest.param(Blow("supervisor", "kill", 0.1, None), marks=pytest.mark.thorough),
    ],
    ids=lambda blow: f"{blow.victim}-{blow.action}",
)
def test_the_response_is_the_one_that_is_stated(blow: Blow, tmp_path: Path) -> None:
    """Of two controllers the other one takes over; of what is silent alone the run ends, with a log, and no orphan."""
    assert faults(blow, strike(blow, tmp_path / "run")) == []
