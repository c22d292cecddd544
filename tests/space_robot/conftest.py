"""A short run."""

from __future__ import annotations

import pytest

import space_robot as sr
from tests.support.short_run import CHANGES, NAME


@pytest.fixture(scope="module")
def run() -> sr.Run:
    """A short run."""
    return sr.run(NAME, CHANGES)
