"""Two controllers in a paced run: one acts at a time, the other one takes over, and every log replays equal."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.errors import SpecError
from tests.support.harness import running_graph
from tests.support.pairs import check_equal, go_on, happened, pair, stopped

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize("supervised", [False, True])
def test_a_standby_takes_over_with_what_the_other_one_knew(tmp_path: Path, supervised: bool) -> None:
    """After three silent periods, with the memory of the law that acted; the log says who acts, and replays equal."""
    overrides = ("supervision=mini_basic",) if supervised else ()
    with pair(tmp_path / "run", *overrides, supervised=supervised) as robot:
        go_on(robot, 10)
        with stopped(robot, "controller"):
            go_on(robot, 12)
    silent, events = happened(tmp_path / "run")
    assert silent == [11, 12, 13]
    assert events == [(0, "acting", "controller"), (14, "acting", "standby")]
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
