"""What the checks of a run add up to: it passed, it failed, or nothing was expected that it could pass."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_bringup.judge.check import Check

PASS, FAIL, NOTHING = "PASS", "FAIL", "completed, nothing was expected"
BUDGETS = "completed within its budgets, nothing was expected of the task"


def passed(checks: Sequence[Check]) -> bool | None:
    """Every check holds and one at least is of the task; None: nothing was expected of the task, and all else holds.

    Args:
        checks: of a run; none: there was nothing to judge, which is a failure.
    """
    if not checks or not all(check.passed for check in checks):
        return False
    return True if any(check.about == "task" for check in checks) else None


def conclusion(checks: Sequence[Check]) -> str:
    """The same in words."""
    found = passed(checks)
    if found is None:
        return BUDGETS if any(check.about == "budget" for check in checks) else NOTHING
    return PASS if found else FAIL
