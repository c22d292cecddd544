"""A client of another DDS implementation, without ROS, commands a whole run."""

from __future__ import annotations

from pathlib import Path
from time import monotonic

import pytest

pytest.importorskip("rclpy")
pytest.importorskip("cyclonedds")
from tests.support.commanded import ALONE, efforts
from tests.support.cyclone import CycloneClient
from tests.support.harness import DEADLINE, running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
EFFORT = 0.0002


def test_a_cyclone_client_answers_every_state(tmp_path: Path) -> None:
    """In lock-step it answers each of the 161 states once, all its answers act, and the log has them."""
    with running_graph(tmp_path / "run", roles=ALONE) as robot:
        client = CycloneClient(robot.context.get_domain_id(), EFFORT)
        end = monotonic() + DEADLINE
        while robot.recorder.end_reason is None:
            robot.executor.spin_once(timeout_sec=0.001)
            client.answer()
            assert monotonic() < end, f"the run is at tick {robot.simulator.tick} after {DEADLINE} s"
        robot.settle()
        assert robot.simulator.end_reason == "completed"
        robot.recorder.finish("completed")
        assert robot.simulator.commands.counts.keys() <= {"repeated"}
        assert sorted(set(client.answered)) == [tick * 250_000_000 for tick in range(161)]
    assert efforts(tmp_path / "run") == [EFFORT] * 161
