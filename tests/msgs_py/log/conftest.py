"""A closed and a killed log of the same ticks."""

import pytest

from tests.support.counted_log import write_log


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A closed log of COUNT ticks."""
    place = tmp_path_factory.mktemp("closed") / "run"
    write_log(place)
    return place


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """The bytes of the same log, killed after its last tick."""
    return write_log(tmp_path_factory.mktemp("killed") / "run")
