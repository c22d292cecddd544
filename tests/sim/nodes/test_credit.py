"""Credit of a recorder, without a graph: it counts for the run it was given for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("rclpy")
from space_robot_msgs_py.codec.codecs import decode_clock, encode_clock
from space_robot_sim.nodes.credit import MAX_AHEAD, Credit, CreditGiver

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


@pytest.mark.parametrize("ahead", [0, 1, 2, 7, 256])
def test_credit_is_given_by_halves_before_anything_waits(ahead: int) -> None:
    """First for state 0 alone; once that is heard, so far ahead of what is written; seldom, and never too late."""
    said: list[int] = []
    node: Any = SimpleNamespace(
        publisher=lambda topic: SimpleNamespace(publish=lambda raw: said.append(decode_clock(raw)))
    )
    giver = CreditGiver(node, PERIOD, ahead)
    for _ in range(2):
        for _ in range(3):
            giver.give(0, heard=False)
        assert said == [0]
        for tick in range(1000):
            giver.give(tick * PERIOD, heard=True)
            assert said[-1] <= (tick + ahead) * PERIOD
            # The state of the tick that is to be written next may be published, and half of what may be ahead of it.
            assert said[-1] > (tick + ahead - max(1, ahead // 2)) * PERIOD
        assert said == sorted(set(said))
        assert len(said) <= 3 + 1000 // max(1, ahead // 2)
        giver.restart()
        said.clear()
