"""Checks of a run's ticks and numbers, at the bounds themselves."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_bringup.experiment.expectations import Expectation
from space_robot_bringup.judge.verdict import check_bounds, check_end, check_ticks

PERIOD = 250_000_000


@pytest.mark.parametrize(
    ("ticks", "whole", "words"),
    [
        ((0, 1, 2, 3), True, ""),
        ((0, 1, 2), False, "; tick 3 at 0.75 s is not complete"),
        ((0, 2, 3), False, "; tick 1 at 0.25 s is not complete"),
        ((1, 2, 3), False, "; tick 0 at 0 s is not complete"),
        ((), False, "; tick 0 at 0 s is not complete"),
        ((0, 1, 2, 3, 4), False, ""),
        ((0, 1, 2, 4), False, "; tick 3 at 0.75 s is not complete"),
    ],
)
def test_a_run_is_whole_with_every_tick_and_no_other(ticks: tuple[int, ...], whole: bool, words: str) -> None:
    """The first one that is missing is named; one more than was asked for is no whole run either."""
    check = check_ticks([tick * PERIOD for tick in ticks], 3, PERIOD)
    assert (check.passed, check.measured) == (whole, len(ticks))
    assert check.wanted == "4 complete ticks up to 0.75 s" + words


def test_what_a_tick_lacks_is_said() -> None:
    """In the words of who knows it, of the first tick that is not whole."""
    check = check_ticks([0, 2 * PERIOD], 2, PERIOD, lacks=lambda tick: f"lacks a part of {tick}")
    assert check.wanted == "3 complete ticks up to 0.5 s; tick 1 at 0.25 s lacks a part of 1"


@pytest.mark.parametrize(
    ("bounds", "kept", "missed"),
    [
        ({"value": 2.0, "tolerance": 0.5}, (1.5, 2.0, 2.5), (1.25, 2.75)),
        ({"min": 2.0}, (2.0, 3.0), (1.75,)),
        ({"max": 2.0}, (2.0, 1.0), (2.25,)),
    ],
)
def test_a_bound_is_kept_at_its_very_value(
    bounds: dict[str, Any], kept: tuple[float, ...], missed: tuple[float, ...]
) -> None:
    """Beyond it is not, and a number that is not there keeps none."""
    wanted = Expectation(**bounds)
    assert [check_bounds("x", value, wanted)[0].passed for value in kept] == [True] * len(kept)
    assert [check_bounds("x", value, wanted)[0].passed for value in (*missed, None)] == [False] * (len(missed) + 1)


def test_every_bound_that_is_stated_is_a_check() -> None:
    """With its words, the id of the expectation, and whether it is of the task or a budget."""
    lower, upper = check_bounds("base/roll.final_error", 1.5, Expectation(min=1.0, max=2.0, id="R1"))
    found = [(one.wanted, one.requirement, one.about) for one in (lower, upper)]
    assert found == [(">= 1", "R1", "task"), ("<= 2", "R1", "task")]
    assert [one.about for one in check_bounds("torque_integral", 1.5, Expectation(max=2.0))] == ["budget"]


@pytest.mark.parametrize(("reason", "ended"), [("completed", True), ("interrupted", False), (None, False)])
def test_only_a_run_that_ends_by_itself_is_completed(reason: str | None, ended: bool) -> None:
    """The check says how it ended."""
    check = check_end(reason)
    assert (check.passed, check.name) == (ended, "completed")
    assert check.wanted == f"the run ends by itself (ended: {reason})"
