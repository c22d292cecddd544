"""The garbage collector during a run: what was there before is left out, and comes back."""

from __future__ import annotations

import gc
import weakref

import pytest

from space_robot_bringup.modes.collector import collecting_new_garbage


class Circle:
    """An object that only the collector frees."""

    def __init__(self) -> None:
        self.itself = self


def test_what_a_run_makes_is_collected_and_what_was_there_is_not_looked_at() -> None:
    """Garbage of the run goes as ever; that of before goes when the run is over."""
    old = weakref.ref(Circle())
    with collecting_new_garbage():
        new = weakref.ref(Circle())
        gc.collect()
        assert new() is None
        assert old() is not None
    gc.collect()
    assert old() is None


def test_an_error_gives_everything_back() -> None:
    """Nothing stays left out when a run fails."""
    with pytest.raises(RuntimeError), collecting_new_garbage():
        raise RuntimeError
    assert gc.get_freeze_count() == 0
