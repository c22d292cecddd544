"""Tests of a group run in one worker, after each other: they share what is made once, or meet the same clock."""

from __future__ import annotations

import os

import pytest


@pytest.mark.xdist_group("names")
@pytest.mark.skipif("PYTEST_XDIST_WORKER" not in os.environ, reason="there are no workers")
def test_a_group_is_known_to_the_workers(request: pytest.FixtureRequest) -> None:
    """The mark reaches the scheduler, which knows tests by their names only: with pytest 9.2 it did not."""
    assert request.node.nodeid.endswith("@names")
