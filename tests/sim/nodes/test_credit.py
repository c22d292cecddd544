"""Credit of a recorder, without a graph: it counts for the run it was given for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("rclpy")
from space_robot_msgs_py.codec.codecs import encode_clock
from space_robot_sim.nodes.credit import MAX_AHEAD, Credit

PERIOD = 10


def credit() -> tuple[Credit, list[Any]]:
    refused: list[Any] = []
    node: Any = SimpleNamespace(refuse=lambda topic, why: refused.append(why))
    return Credit(node), refused


@settings(deadline=None, max_examples=100)
@given(ahead=st.integers(0, MAX_AHEAD), runs=st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), min_size=1))
def test_credit_of_a_run_before_never_counts(ahead: int, runs: list[tuple[int, int]]) -> None:
    """Whatever of it comes before a reset and whatever after, a run starts with the first credit that is its own."""
    taken, refused = credit()
    for written, late in runs:
        for tick in range(written + 1):
            assert taken.take(encode_clock((tick + ahead) * PERIOD), tick * PERIOD, PERIOD)
            assert taken.until == (tick + ahead) * PERIOD
        taken.restart()
        assert not taken.given
        for tick in range(written + 1, written + 1 + late):
            assert not taken.take(encode_clock((tick + ahead) * PERIOD), 0, PERIOD)
            assert not taken.given
    assert refused == []


@pytest.mark.parametrize(
    "raw", [b"", b"\x00\x01\x00\x00" + b"\xff" * 8, encode_clock(17), encode_clock((MAX_AHEAD + 2) * PERIOD)]
)
def test_what_no_recorder_gives_is_refused(raw: bytes) -> None:
    """No time, no multiple of the period, or more than a recorder can know of the run: counted, and nothing changes."""
    taken, refused = credit()
    assert not taken.take(raw, 0, PERIOD)
    assert not taken.given
    assert len(refused) == 1
