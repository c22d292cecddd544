"""The papers that are shipped can be reproduced: everything they name exists."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_description.share import shipped
from space_robot_studies.reproduce.plan import load_plan
from space_robot_studies.reproduce.reproduction import prepare


@pytest.mark.parametrize("paper", shipped("papers"))
def test_a_shipped_paper_is_complete(tmp_path: Path, paper: str) -> None:
    """Every run of every figure composes, every metric, signal and measure is known, every claim has words."""
    plan = load_plan(paper)
    prepare(plan, list(plan.manifest.figures), tmp_path / "out")
    assert any(figure.claims for figure in plan.manifest.figures.values())
    assert not (tmp_path / "out").exists()
