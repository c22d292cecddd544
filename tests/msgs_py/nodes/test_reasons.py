"""Every reason why messages are refused is said, none too often; and what is over is no warning any more."""

from __future__ import annotations

import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.nodes.reasons import MAX_REASONS, RECENT, THROTTLE_SECONDS, Reasons, RecentCounts


def test_each_reason_of_a_topic_is_said_now_and_then() -> None:
    """Numbers in it make it no other one; after a while it is said again, with how many there were."""
    now = 0.0
    reasons = Reasons(lambda: now)
    assert reasons.add("a", "stamp 17 ns is too old") == "stamp 17 ns is too old"
    assert reasons.add("a", "stamp 18 ns is too old") is None
    assert reasons.add("a", "joints are missing") == "joints are missing"
    assert reasons.add("b", "stamp 17 ns is too old") is not None
    now = THROTTLE_SECONDS
    assert reasons.add("a", "stamp 19 ns is too old") == "stamp 19 ns is too old (1 more since the last time)"


def test_the_newest_reason_is_there_for_every_topic() -> None:
    """Also where it was not said."""
    reasons = Reasons(lambda: 0.0)
    for stamp in (1, 2):
        reasons.add("a", f"stamp {stamp}")
        reasons.add("b", "nonsense")
    reasons.add("a", "stamp 3")
    assert reasons.values() == {"reason_a": "stamp 3", "reason_b": "nonsense", "newest_reason": "a: stamp 3"}
    assert Reasons().values() == {}


def test_reasons_without_end_fill_no_memory() -> None:
    """A stranger that finds a new one each time is heard of, up to a number."""
    reasons = Reasons(lambda: 0.0)
    said = [reasons.add("a", "x" * length) for length in range(1, 2 * MAX_REASONS)]
    assert sum(line is not None for line in said) == MAX_REASONS


def test_counts_are_news_for_a_few_periods() -> None:
    """What grew lately comes with how much; a count that begins again after a reset is one from nothing."""
    recent = RecentCounts()
    assert recent.grown({"late": 2}) == {"late": 2}
    for _ in range(RECENT - 1):
        assert recent.grown({"late": 2}) == {"late": 2}
    assert recent.grown({"late": 2}) == {}
    assert recent.grown({"late": 3, "missed": 1}) == {"late": 1, "missed": 1}
    assert recent.grown({"late": 1}) == {"late": 1}
