"""Where a recorder writes, one log after another, and what it adds to the ticks that it heard."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any, Protocol

from space_robot_msgs_py.codec.codecs import decode_events, encode_events, is_empty
from space_robot_msgs_py.events import ACTING, LATE, PUBLISHERS, ControllerEvent
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, Topic
from space_robot_sim.nodes.left_out import LeftOut
from space_robot_sim.nodes.tick_parts import Parts


class TickWriter(Protocol):
    """Where ticks are written: a LogWriter."""

    def write_description(self, urdf: str) -> None:
        """The robot, first of all."""

    def write_tick(self, stamp: int, parts: Parts) -> None:
        """All messages of one stamp."""

    def close(self, reason: str) -> None:
        """No more ticks."""


class TickLog:
    """The log of the run, and after a reset the next one.

    Args:
        open_writer: gives the writer of the k-th log of this run, k = 0 first.
        period: control period [ns].
        optional: optional topics, of which a message may say that there is nothing.
        paced: what is left out is looked for.

    Attributes:
        number: of this log, 0 first.
        left_out: of this log.
    """

    def __init__(
        self, open_writer: Callable[[int], TickWriter], period: int, optional: Collection[Topic], *, paced: bool
    ) -> None:
        self._open_writer, self._period, self._optional, self._paced = open_writer, period, optional, paced
        self.number, self._writer = 0, open_writer(0)
        self.left_out = LeftOut(period)
        self._acted, self._acting = "", dict[int, str]()

    def write_description(self, urdf: str) -> None:
        """The robot, first of all."""
        self._writer.write_description(urdf)

    def write(self, stamp: int, parts: Parts, publishers: list[dict[str, Any]]) -> None:
        """A tick, with the news of who publishes."""
        news = [ControllerEvent(stamp, PUBLISHERS, content) for content in publishers]
        if self._acting:
            for at in sorted(at for at in self._acting if at <= stamp):
                news.append(ControllerEvent(stamp, ACTING, {"node": self._acting.pop(at)}))
        if self._paced and (late := self.left_out.answered()):
            news.append(ControllerEvent(stamp, LATE, {"stamps": late}))
        if news:
            own = decode_events(parts[CONTROLLER_EVENTS]) if CONTROLLER_EVENTS in parts else ()
            parts[CONTROLLER_EVENTS] = encode_events([*news, *own])
        for topic in self._optional:
            if topic in parts and is_empty(topic, parts[topic]):
                del parts[topic]
        self._writer.write_tick(stamp, parts)
        if self._paced:
            self.left_out.look(stamp, parts)

    def note_acting(self, stamp: int, node: str) -> None:
        """Of two controllers this one answered the state of this stamp [ns]; an event where another one did before."""
        if node != self._acted:
            self._acted = self._acting[stamp] = node

    def close(self, reason: str) -> None:
        """No more ticks."""
        self._writer.close(reason)

    def begin_again(self) -> None:
        """The next log."""
        self.number += 1
        self._writer = self._open_writer(self.number)
        self.left_out = LeftOut(self._period)
        self._acted, self._acting = "", {}
