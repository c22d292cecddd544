"""What a law's first answer needs is there before it: a node compiles before it takes part in a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import space_robot as sr
from space_robot_control.laws import compiled
from space_robot_control.laws.base import Blocks, Law
from space_robot_control.laws.registry import make_law
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from space_robot_msgs_py.log.reader import LogReader
from tests.support.replays import record_run

ROBOTS = {"computed_torque": "mini", "mfac": "mini", "ntsmc": "servicer", "pd": "mini", "park": "mini"}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_prepared_law_compiles_nothing_at_its_first_answer(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """All that it calls is loaded by ``prepare``."""
    plant = sr.make_plant(f"compare/{ROBOTS[name]}")
    law = make_law(name, plant.robot, 0.25)
    law.prepare()

    def late(*_: Any) -> None:
        raise AssertionError("compiled at the first answer")

    monkeypatch.setattr(compiled, "bound", late)
    assert np.isfinite(law.update(plant.state, plant.reference).command.u).all()


class Unprepared(Law):
    """Answers nothing before it was prepared."""

    name = "unprepared"
    prepared = False

    def prepare(self) -> None:
        """From now on it answers."""
        self.prepared = True

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return zero."""
        assert self.prepared
        return np.zeros(6 + self.n), {}


@pytest.mark.ros
def test_a_node_prepares_its_law(tmp_path: Path) -> None:
    """It does so before the first state."""
    pytest.importorskip("rclpy")
    law = f"controller.law={__name__}:Unprepared"
    bag = record_run(tmp_path / "run", "compare/mini", "duration=1.0", law, mode="graph")
    assert LogReader(bag).end_reason == "completed"
