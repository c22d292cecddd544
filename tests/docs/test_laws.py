"""The pages of the laws: tables made from the laws themselves, every block described, formulas that Markdown keeps."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from space_robot_control.docs import filled
from space_robot_control.laws import law_class, make_law
from space_robot_control.laws.registry import BUILT_IN
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.paths import ROOT

DOCS = ROOT / "docs"
PAGES = {page.stem: page.read_text(encoding="utf-8") for page in sorted((DOCS / "laws").glob("*.md"))}
PAGE_OF = {"ntsmc_euler": "ntsmc"}
# Gains under which a law has other telemetry than with its defaults.
OTHERS: dict[str, list[dict[str, Any]]] = {
    "adaptive": [{"update": update} for update in ("none", "lyapunov", "composite")],
    "mfac": [{"form": "position"}, {"initial": {"source": "push"}}, {"filter": {}}],
    "pd": [{"filter": {}}],
}


@pytest.mark.parametrize("page", PAGES)
def test_the_tables_of_a_page_are_up_to_date(page: str) -> None:
    """Gains and telemetry on a page are those of the law: python -m space_robot_control.docs docs/laws/*.md."""
    assert filled(PAGES[page]) == PAGES[page]


@pytest.mark.parametrize("name", sorted(set(BUILT_IN) - {"none"}))
def test_every_law_has_a_page_with_all_its_tables_and_its_reference(name: str) -> None:
    """Its gains, its telemetry and the way to its one screen are on the page that its name says."""
    text = PAGES[PAGE_OF.get(name, name)]
    assert f"<!-- gains of {name}" in text
    assert f"<!-- telemetry of {PAGE_OF.get(name, name)}" in text
    assert "reference.py)" in text
    assert "**Not proven**" in text
    assert law_class(name).telemetry_fields == law_class(PAGE_OF.get(name, name)).telemetry_fields
    assert f"`{name}`" in (DOCS / "laws.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_block_of_telemetry_is_described_with_its_unit(name: str) -> None:
    """With any gains the labels are among the described ones, and each of these is one on some robot."""
    seen: set[str] = set()
    fields = law_class(name).telemetry_fields
    for robot in map(load_robot, ("mini", "servicer")):
        q, still = np.array([0, 0, 0, 0, 0, 0, 1.0, *robot.home]), np.zeros(6 + robot.n)
        state = RobotState(0, q, still, np.zeros(robot.n), np.zeros(3))
        for gains in ({}, *OTHERS.get(name, [])):
            telemetry = make_law(name, robot, 0.25, gains).update(state, Reference(0, q, still, still)).telemetry
            assert set(telemetry.labels) <= set(fields)
            seen |= set(telemetry.labels)
    assert seen == set(fields)
    assert all(re.search(r"\[.+\]$", text) for text in fields.values())


def test_formulas_have_no_backslash_that_markdown_takes_away() -> None:
    """Before punctuation Markdown reads a backslash as an escape, also inside a formula."""
    for page, text in PAGES.items():
        for formula in re.findall(r"\$\$.+?\$\$|\$[^$\n]+\$", text, re.DOTALL):
            assert not re.search(r"\\[!-/:-@\[-`{-~]", formula), f"{page}: {formula}"
