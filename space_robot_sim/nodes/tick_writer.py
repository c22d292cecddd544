"""Where a recorder writes."""

from __future__ import annotations

from typing import Protocol

from space_robot_msgs_py.topics import Topic


class TickWriter(Protocol):
    """Where the recorder writes: a LogWriter."""

    def write_description(self, urdf: str) -> None:
        """The robot, first of all."""

    def write_tick(self, stamp: int, parts: dict[Topic, bytes]) -> None:
        """All messages of one stamp."""

    def close(self, reason: str) -> None:
        """No more ticks."""
