"""One bound, or one condition, and what became of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Literal

Outcome = Literal["PASS", "COMPLETED", "NOT JUDGED", "FAIL"]
# What is said of a run that keeps its bounds where none of them is about its task.
NOTHING_EXPECTED = "completed, nothing was expected"


@dataclass(frozen=True, slots=True)
class Check:
    """One bound and what was measured.

    Attributes:
        name: metric, e.g. ``base/roll.settling_time``, signal, ``mode.NAME`` or ``events.NAME``.
        measured: None where the run has no such number (never settled).
        wanted: the bound in words.
        passed: it holds.
        requirement: id of what it verifies; empty where none is said.
        reason: what the run showed, with time and tick, where a number does not say it.
        judged: the run tells whether it holds; what it does not tell is not passed.
    """

    name: str
    measured: float | None
    wanted: str
    passed: bool
    requirement: str = ""
    reason: str = ""
    _: KW_ONLY
    about: Literal["run", "budget", "task"] = "run"
    judged: bool = True

    @property
    def word(self) -> str:
        """``holds``, ``fails`` or ``not judged``."""
        return "holds" if self.passed else "fails" if self.judged else "not judged"

    @property
    def line(self) -> str:
        """What became of it, in one line."""
        what = "failed" if self.word == "fails" else self.word
        name = f"{self.name} ({self.requirement})" if self.requirement else self.name
        if self.reason:
            return f"{what}: {name}, wanted {self.wanted}: {self.reason}"
        measured = "none" if self.measured is None else f"{self.measured:g}"
        return f"{what}: {name} is {measured}, wanted {self.wanted}"


def outcome(checks: Sequence[Check]) -> Outcome:
    """The verdict in a word: PASS needs everything to hold, and something of it to be about the task."""
    if any(check.judged and not check.passed for check in checks) or not checks:
        return "FAIL"
    if not all(check.judged for check in checks):
        return "NOT JUDGED"
    return "PASS" if any(check.about == "task" for check in checks) else "COMPLETED"
