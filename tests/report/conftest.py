"""A run to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.report_pages import recorded


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of fig08."""
    return recorded(tmp_path_factory.mktemp("bags") / "fig08")
