"""Real URDFs of others: they load, or are refused for the reason that docs/example_robots.md shows."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

import pytest

from space_robot_description.example_robots import page
from tests.support.paths import ROOT

PAGE = ROOT / "docs" / "example_robots.md"


def _same_wheel() -> bool:
    try:
        return f"`example-robot-data` {version('example-robot-data')} " in PAGE.read_text(encoding="utf-8")
    except PackageNotFoundError:
        return False


@pytest.mark.skipif(not _same_wheel(), reason="example-robot-data is not installed, or not in the version of the page")
def test_the_page_of_example_robots_is_true(capfd: pytest.CaptureFixture[str]) -> None:
    """Every URDF of the wheel does what the page says, errors in one line, and nothing is printed meanwhile."""
    assert page() == PAGE.read_text(encoding="utf-8")
    assert capfd.readouterr() == ("", "")
