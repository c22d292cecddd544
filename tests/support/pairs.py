"""Two controllers in a paced run, whose periods end when a test says so, and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from space_robot_bringup.modes.hooks import roles_of
from space_robot_msgs_py.codec.codecs import decode_events, peek_stamp
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, WRENCH_COMMAND
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import replayed

PERIOD, AFTER = 250_000_000, 3
# Laws that remember: what they answer tells whether they know what the other one knew. The second one does not give up.
ADAPTIVE = ("controller.gains.update=rls",)
MODEL_FREE = ("controller={law: mfac, gains: {lead: 4.0, kappa: 2.0}}",)
# Periods end when the test says so.
SLOW = 2e-3


@contextmanager
def pair(
    place: Path, *overrides: str, law: tuple[str, ...] = ADAPTIVE, supervised: bool = False
) -> Iterator[RunningGraph]:
    """A run with two controllers, at its first state."""
    overrides = ("duration=10.0", *law, *overrides)
    roles = roles_of(supervised=supervised, failover=True)
    with running_graph(place, *overrides, roles=roles, realtime=SLOW, failover=AFTER) as robot:
        # The controllers may be matched later than the simulator starts.
        robot.await_answer()
        robot.settle()
        yield robot


def go_on(robot: RunningGraph, periods: int) -> None:
    """Let so many periods end."""
    for _ in range(periods):
        robot.simulator._on_period()
        robot.settle()


class Stop:
    """What some readers of a node hear waits, as with SIGSTOP or on a slow link, until they go on, in its order.

    Args:
        robot: the run.
        readers: that hear nothing.
        concerned: which messages wait; the others are heard.
    """

    def __init__(
        self, robot: RunningGraph, readers: list[Any], concerned: Callable[[bytes], bool] = lambda raw: True
    ) -> None:
        self._robot, self._readers = robot, readers
        self._heard: list[tuple[Any, bytes]] = []
        self._callbacks = [reader.callback for reader in readers]
        for reader, callback in zip(readers, self._callbacks, strict=True):
            reader.callback = self._keeper(callback, concerned)

    def _keeper(self, callback: Any, concerned: Callable[[bytes], bool]) -> Callable[[bytes], None]:
        return lambda raw: self._heard.append((callback, raw)) if concerned(raw) else callback(raw)

    def go_on(self) -> None:
        """It hears what it did not hear, and goes on."""
        for reader, callback in zip(self._readers, self._callbacks, strict=True):
            reader.callback = callback
        for callback, raw in self._heard:
            callback(raw)
        self._robot.settle()


@contextmanager
def stopped(robot: RunningGraph, role: str) -> Iterator[None]:
    """As SIGSTOP and SIGCONT would: it hears nothing, and then everything."""
    stop = Stop(robot, list(robot.nodes[role].subscriptions))
    yield
    stop.go_on()


@contextmanager
def under_way(robot: RunningGraph, first: int, last: int | None = None) -> Iterator[None]:
    """Answers to states from tick ``first`` on, to ``last``, arrive at the end of the block."""

    def concerned(raw: bytes) -> bool:
        tick = peek_stamp(raw) // PERIOD
        return first <= tick <= (tick if last is None else last)

    stop = Stop(robot, robot.simulator.commands.readers, concerned)
    yield
    stop.go_on()


def happened(place: Path) -> tuple[list[int], list[tuple[int, str, str]]]:
    """Ticks without a command, and (tick, kind, node) of who acts and of every reset."""
    silent, events = [], []
    for stamp, parts in LogReader(place).stamps():
        silent += [] if WRENCH_COMMAND.name in parts else [stamp // PERIOD]
        for event in decode_events(parts[CONTROLLER_EVENTS.name]) if CONTROLLER_EVENTS.name in parts else ():
            if event.kind in ("acting", "reset"):
                events.append((stamp // PERIOD, event.kind, str(event.content.get("node", ""))))
    return silent, events


def check_equal(place: Path) -> None:
    """Controller, plant and, where there is one, supervisor."""
    result = replayed(place)
    assert result.equal, [(one.against, one.first, one.remarks) for one in result.outcomes]
