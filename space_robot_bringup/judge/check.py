"""One bound, or one condition, and what became of it."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Literal


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
        about: the run as a whole, a budget such as effort, or the task.
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
