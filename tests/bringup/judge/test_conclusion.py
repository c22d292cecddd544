"""A verdict says PASS only where something was expected of the task, and names what else happened beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import space_robot
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.conclusion import BUDGETS, FAIL, NOTHING, PASS, conclusion, passed
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info

WHOLE = Check("completed", None, "", True)
BUDGET = Check("effort_integral", 1.0, "<= 2", True, about="budget")
TASK = Check("base.rate", 0.1, "never above 0.2 rad/s", True, about="task")
OPEN = Check("mode.SAFE", None, "within 5 s", False, about="task", judged=False)


@pytest.mark.parametrize(
    ("checks", "found", "words"),
    [
        ((), False, FAIL),
        ((WHOLE,), None, NOTHING),
        ((WHOLE, BUDGET), None, BUDGETS),
        ((WHOLE, TASK), True, PASS),
        ((WHOLE, TASK, OPEN), False, FAIL),
        ((Check("completed", None, "", False),), False, FAIL),
    ],
)
def test_only_what_was_expected_of_the_task_can_pass(checks: tuple[Check, ...], found: bool | None, words: str) -> None:
    """Bounds that hold for every run, and budgets, make no PASS; whatever is missed or not judged makes a FAIL."""
    assert (passed(checks), conclusion(checks)) == (found, words)


def test_a_run_of_which_nothing_was_expected_did_not_pass() -> None:
    """Its verdict is neither true nor false, and says so."""
    run = space_robot.run("liu2023/fig08", {"duration": 1.0, "expect": {}})
    assert (run.passed, run.conclusion) == (None, NOTHING)
    assert NOTHING in repr(run)


# What is done to fig08, what must be said of it, and the first tick it is seen at [ns].
REMARKS: dict[str, tuple[dict[str, Any], str, int]] = {
    "joint limits": (
        {"faults": [{"kind": "joint_runaway", "joint": "joint4", "at": 1.0, "for": 3.0}]},
        "joint4 was up to ",
        1_250_000_000,
    ),
    "wheels full": (
        {"faults": [{"kind": "wrench_pulse", "torque": [0.0, 0.0, 0.3], "at": 1.0, "for": 9.0}], "duration": 10.0},
        "wheel 2 (from 0) held up to 2 N m s of 2, for ",
        7_750_000_000,
    ),
    "missed commands": (
        {"faults": [{"kind": "controller_silent", "at": 2.0, "for": 1.0}]},
        "no answer to the state acted in 4 periods, first at 2.25 s (tick 9)",
        2_250_000_000,
    ),
    "tumbling": (
        {"faults": [{"kind": "wrench_pulse", "torque": [0.0, 0.0, 4.0], "at": 2.0, "for": 1.0}]},
        "rad/s faster than was desired, above 0.3 for ",
        2_250_000_000,
    ),
}


@pytest.mark.parametrize("name", REMARKS)
def test_what_happened_is_named_beside_the_verdict(name: str, tmp_path: Path) -> None:
    """With number, time and tick, alike in the run, its log and its page; the verdict is what it would be anyway."""
    changes, words, since = REMARKS[name]
    run = space_robot.run("liu2023/fig08", {"duration": 5.0, "expect": {}} | changes, out=tmp_path / "run")
    found = {remark.name: remark for remark in run.remarks}
    assert name in found, [remark.line for remark in run.remarks]
    assert words in found[name].text, found[name].text
    assert since == found[name].since
    assert run.passed is not True
    assert read_judged(run.directory).remarks == bag_info(run.directory).verdict.remarks == run.remarks


@pytest.mark.parametrize("changes", [{}, {"plant.delay_periods": 1, "nominal.delay_periods": 1}])
def test_of_a_run_as_it_should_be_nothing_is_remarked(changes: dict[str, Any]) -> None:
    """A delayed command is no missed one, and the last tick has none to miss."""
    assert space_robot.run("liu2023/fig08", {"duration": 5.0, "expect": {}} | changes).remarks == ()
