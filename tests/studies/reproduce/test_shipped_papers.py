"""The papers that are shipped can be reproduced: everything they name exists."""

from __future__ import annotations

import pytest

from space_robot_description.share import shipped
from space_robot_studies.reproduce.check import check_plan
from space_robot_studies.reproduce.plan import load_plan


@pytest.mark.parametrize("paper", shipped("papers"))
def test_a_shipped_paper_is_complete(paper: str) -> None:
    """Every run of every figure composes, every metric, signal and measure is known, every claim has words."""
    plan = load_plan(paper)
    check_plan(plan, plan.manifest.figures)
    assert any(figure.claims for figure in plan.manifest.figures.values())
