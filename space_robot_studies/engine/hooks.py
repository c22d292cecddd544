"""What a study and the code that started it say to each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from space_robot_studies.engine.tasks import Stop


@dataclass(frozen=True, slots=True)
class StudyHooks:
    """Progress, warnings and an early end of a campaign, a comparison or a reproduction.

    Attributes:
        on_ready: called when the workers are ready: how many runs are finished already, and how many there are.
        on_row: called after each run: how many are finished.
        stop: asked often; a reason ends the study.
        warn: called before the first run with what a law warns of.
    """

    on_ready: Callable[[int, int], None] = lambda done, total: None
    on_row: Callable[[int], None] = lambda done: None
    stop: Stop = lambda: None
    warn: Callable[[str], None] = lambda warning: None
