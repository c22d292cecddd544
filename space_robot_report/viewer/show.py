"""What the viewer shows of a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from space_robot_bringup.logs.happened import Happened
from space_robot_bringup.logs.spans import NO_SPANS, Spans
from space_robot_description.visual import Look
from space_robot_report.playback import Footage


@dataclass(frozen=True, eq=False, slots=True)
class Show:
    """What is shown.

    Attributes:
        look: the robot.
        film: its log.
        tool: the link whose way is drawn.
        title: of the run.
        about: a line or two on it, as HTML.
        spans: modes and faults of the run.
        events: of the run, in order.
        desired: it is known what was desired.
    """

    look: Look
    film: Footage
    tool: str
    title: str
    about: str
    spans: Spans = NO_SPANS
    events: Sequence[Happened] = ()
    desired: bool = True
