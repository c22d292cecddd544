"""Two controllers in a paced run: one acts at a time, the other one takes over, and every log replays equal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.modes.hooks import roles_of
from space_robot_msgs_py.codec.codecs import decode_events
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, WRENCH_COMMAND
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PERIOD, AFTER = 250_000_000, 3
# A law that remembers: what it answers tells whether it knows what the other one knew.
OVERRIDES = ("duration=10.0", "controller.gains.update=rls")
# Periods end when the test says so.
SLOW = 2e-3


@contextmanager
def pair(place: Path, *overrides: str, supervised: bool = False) -> Iterator[RunningGraph]:
    """A run with two controllers, at its first state."""
    roles = roles_of(supervised=supervised, failover=True)
    with running_graph(place, *OVERRIDES, *overrides, roles=roles, realtime=SLOW, failover=AFTER) as robot:
        # The controllers may be matched later than the simulator starts.
        robot.await_answer()
        robot.settle()
        yield robot


def go_on(robot: RunningGraph, periods: int) -> None:
    """Let so many periods end."""
    for _ in range(periods):
        robot.simulator._on_period()
        robot.settle()


@contextmanager
def stopped(robot: RunningGraph, role: str) -> Iterator[None]:
    """As SIGSTOP and SIGCONT would: it hears nothing, and then everything."""
    readers = list(robot.nodes[role].subscriptions)
    heard: list[tuple[Any, bytes]] = []
    callbacks = [reader.callback for reader in readers]
    for reader, callback in zip(readers, callbacks, strict=True):
        reader.callback = lambda raw, callback=callback: heard.append((callback, raw))
    yield
    for reader, callback in zip(readers, callbacks, strict=True):
        reader.callback = callback
    for callback, raw in heard:
        callback(raw)
    robot.settle()


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


@pytest.mark.parametrize("supervised", [False, True])
def test_a_standby_takes_over_with_what_the_other_one_knew(tmp_path: Path, supervised: bool) -> None:
    """After three silent periods, with the memory of the law that acted; the log says who acts, and replays equal."""
    overrides = ("supervision=mini_basic",) if supervised else ()
    with pair(tmp_path / "run", *overrides, supervised=supervised) as robot:
        go_on(robot, 10)
        with stopped(robot, "controller"):
            go_on(robot, 12)
    silent, events = happened(tmp_path / "run")
    # The state of the last silent period it may still answer, late.
    assert silent in ([11, 12], [11, 12, 13])
    assert events == [(0, "acting", "controller"), (silent[-1] + 1, "acting", "standby")]
    check_equal(tmp_path / "run")


def test_a_controller_that_comes_back_stands_by(tmp_path: Path) -> None:
    """It says nothing out of turn; when the other one is silent it takes over, reset, for it missed what that did."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 5)
        with stopped(robot, "controller"):
            go_on(robot, 8)
        counts = dict(robot.simulator.commands.counts)
        go_on(robot, 4)
        assert robot.simulator.commands.counts == counts
        with stopped(robot, "standby"):
            go_on(robot, 10)
    silent, events = happened(tmp_path / "run")
    assert silent == [6, 7, 8, 18, 19, 20]
    acting = [(0, "acting", "controller"), (9, "acting", "standby"), (21, "acting", "controller")]
    assert events == [*acting, (21, "reset", "")]
    check_equal(tmp_path / "run")


def test_a_standby_that_was_stopped_begins_again(tmp_path: Path) -> None:
    """What it missed it hears late; it follows, or is reset: either way the log replays equal."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 4)
        with stopped(robot, "standby"):
            go_on(robot, 6)
        go_on(robot, 2)
        with stopped(robot, "controller"):
            go_on(robot, 8)
    _, events = happened(tmp_path / "run")
    assert [(kind, node) for _, kind, node in events] == [("acting", "controller"), ("acting", "standby")]
    check_equal(tmp_path / "run")


def test_turns_begin_again_with_the_run(tmp_path: Path) -> None:
    """After a reset the first controller acts, and both laws know nothing."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 4)
        with stopped(robot, "controller"):
            go_on(robot, 6)
        robot.simulator.reset()
        robot.settle()
        go_on(robot, 6)
    assert happened(tmp_path / "run_reset1") == ([], [(0, "acting", "controller")])
    for name in ("run", "run_reset1"):
        check_equal(tmp_path / name)


@pytest.mark.parametrize(("failover", "realtime"), [(3, None), (51, 1.0), (-1, 1.0)])
def test_what_cannot_be_is_refused(tmp_path: Path, failover: int, realtime: float | None) -> None:
    """Lock-step waits for its controller; and a command that is so late acts no more."""
    with (
        pytest.raises(SpecError, match="failover"),
        running_graph(tmp_path / "run", roles=("controller",), realtime=realtime, failover=failover),
    ):
        pass
