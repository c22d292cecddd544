"""The wheel, built once for all that look into it or install it: they are of one group."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.distribution import build_wheel


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of the wheel."""
    return build_wheel(tmp_path_factory.mktemp("wheel"))
