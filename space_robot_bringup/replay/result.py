"""What came out of computing a recorded run again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from space_robot_bringup.replay.comparison import Comparison, Divergence
from space_robot_msgs_py.topics import Topic

Against = Literal["controller", "plant", "supervisor"]


@dataclass(frozen=True, eq=False, slots=True)
class Outcome:
    """The verdict of one replay.

    Attributes:
        against: what was computed afresh.
        comparison: of its messages with those of the log.
        ticks: how many stamps were computed.
        last: the last of them [ns].
        absent: topics that were computed and are not in the log at all.
        remarks: what was not compared, and why.
    """

    against: Against
    comparison: Comparison
    ticks: int
    last: int
    absent: tuple[str, ...]
    remarks: tuple[str, ...] = ()

    @property
    def equal(self) -> bool:
        """Something was compared and nothing is different."""
        return self.comparison.first is None

    @property
    def first(self) -> Divergence | None:
        """The first number that is different."""
        return self.comparison.first


def absent_topics(comparison: Comparison, topics: Sequence[Topic], ignored: Sequence[str]) -> tuple[str, ...]:
    """Topics of which nothing was compared although they were not ignored."""
    return tuple(topic.name for topic in topics if topic.name not in ignored and not comparison.compared[topic.name])
