"""Gains that change in a run with two controllers: both have them, and the log says since when."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.codec.codecs import decode_events
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import CONTROLLER_EVENTS
from tests.support.pairs import PERIOD, check_equal, go_on, happened, pair, stopped

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
KAPPA = "gains.kappa"


def changes(place: Path) -> list[tuple[int, object]]:
    """(tick, values) of every change of gains in a log."""
    found = []
    for stamp, parts in LogReader(place).stamps():
        events = decode_events(parts[CONTROLLER_EVENTS.name]) if CONTROLLER_EVENTS.name in parts else ()
        found += [(stamp // PERIOD, event.content["values"]) for event in events if event.kind == "parameters"]
    return found


def test_a_change_at_the_one_that_acts_reaches_the_other_one(tmp_path: Path) -> None:
    """It takes over with those gains and with the memory that goes with them, and shows them as its parameters."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 5)
        robot.nodes["controller"].tune({KAPPA: 0.25})
        go_on(robot, 3)
        assert robot.nodes["standby"].get_parameter(KAPPA).value == 0.25
        with stopped(robot, "controller"):
            go_on(robot, 7)
    assert changes(tmp_path / "run") == [(6, {KAPPA: 0.25})]
    _, events = happened(tmp_path / "run")
    assert [kind for _, kind, _ in events] == ["acting", "acting"]
    check_equal(tmp_path / "run")


def test_a_change_reaches_one_that_has_lost_its_turn(tmp_path: Path) -> None:
    """Its law does not follow any more, but begins again with the gains that hold."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 3)
        with stopped(robot, "controller"):
            go_on(robot, 6)
            robot.nodes["standby"].tune({KAPPA: 0.25})
            go_on(robot, 3)
        assert robot.nodes["controller"].get_parameter(KAPPA).value == 0.25
        with stopped(robot, "standby"):
            go_on(robot, 7)
    found = changes(tmp_path / "run")
    assert [values for _, values in found] == [{KAPPA: 0.25}, {KAPPA: 0.25}]
    check_equal(tmp_path / "run")


def test_a_change_at_the_one_that_stands_by_is_refused(tmp_path: Path) -> None:
    """With the name of the one that acts."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 2)
        with pytest.raises(SpecError, match=r"gains.kappa: this controller stands by; .*a change at controller"):
            robot.nodes["standby"].tune({KAPPA: 0.25})
        go_on(robot, 2)
    assert changes(tmp_path / "run") == []


def test_a_change_that_came_with_a_refused_answer_acts_in_the_next_turn(tmp_path: Path) -> None:
    """The other one never heard of it; the log has it when its controller acts again."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 3)
        robot.nodes["controller"].tune({KAPPA: 0.25})
        with stopped(robot, "controller"):
            go_on(robot, 7)
        assert robot.nodes["standby"].get_parameter(KAPPA).value != 0.25
        with stopped(robot, "standby"):
            go_on(robot, 7)
    assert [values for _, values in changes(tmp_path / "run")] == [{KAPPA: 0.25}]
    check_equal(tmp_path / "run")
