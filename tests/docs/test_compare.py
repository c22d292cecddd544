"""The results on the pages are those of the shipped table, computed from its draws."""

from __future__ import annotations

import pytest

pytest.importorskip("scipy")

from space_robot_description.share import config_dir
from space_robot_studies.benchmark.docs import filled
from space_robot_studies.benchmark.spec import load_benchmark
from space_robot_studies.benchmark.table import read_table
from tests.support.paths import ROOT

PAGES = ["README.md", "docs/compare.md", "docs/compare-glance.md", "docs/compare-points.md"]


@pytest.mark.parametrize("page", PAGES)
def test_the_results_on_a_page_are_those_of_the_shipped_table(page: str) -> None:
    """Every cell and every sentence: python -m space_robot_studies.benchmark.docs README.md docs/compare*.md."""
    text = (ROOT / page).read_text(encoding="utf-8")
    assert "<!-- results of v1" in text
    assert filled(text) == text


def test_the_shipped_table_is_of_the_rules_of_the_set() -> None:
    """As many held-out draws as the rules say, of the tasks as they are today, every law of the set at every point."""
    benchmark = load_benchmark("v1")
    table = read_table(config_dir() / "benchmarks" / "v1.json", benchmark)
    assert table.rows
    for row in table.rows:
        assert len(row["tuned"]) == len(row["shipped"]) == benchmark.rules.held_out
    points = {(row["task"], str(row["point"])) for row in table.rows}
    assert len(table.rows) == len(points) * len(benchmark.laws)
