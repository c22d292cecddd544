"""The pages of the papers say what their manifests expect: every claim, in order, with its verdict."""

from __future__ import annotations

import re

import pytest

from space_robot_description.share import shipped
from space_robot_studies.reproduce.manifest import Manifest
from space_robot_studies.reproduce.plan import manifest_path, read_manifest
from tests.docs.pages import ROOT

PAGES = ROOT / "docs" / "papers"


def documented(paper: str) -> list[tuple[str, str, str]]:
    """Figure, claim and verdict of every row of the page that is no reading."""
    text = (PAGES / f"{paper}.md").read_text()
    (block,) = re.findall(r"<!-- claims[^>]*-->(.*?)<!-- end -->", text, re.DOTALL)
    rows = [
        [cell.strip() for cell in line.strip().strip("|").split(" | ")] for line in block.splitlines() if "|" in line
    ]
    claims = [(row[0], row[1], row[2].strip("*")) for row in rows[2:] if row[0]]
    assert claims
    return claims


def expected(manifest: Manifest) -> list[tuple[str, str, str]]:
    return [
        (name, " ".join(claim.paper.split()).replace("|", "&#124;"), claim.expect or "study")
        for name, figure in manifest.figures.items()
        for claim in figure.claims
    ]


@pytest.mark.parametrize("paper", shipped("papers"))
def test_the_page_has_the_verdicts_that_are_expected(paper: str) -> None:
    """Claim by claim; a claim without an expected verdict is a study, and only that."""
    manifest = read_manifest(manifest_path(paper), paper)
    assert documented(paper) == expected(manifest)
    for figure in manifest.figures.values():
        for claim in figure.claims:
            assert bool(claim.expect) == bool(claim.holds_if or not claim.measures), claim.paper
