"""Two controllers whose messages come late, in any order: what the law of the one that acts knows is in the log."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

pytest.importorskip("rclpy")
from space_robot_sim.nodes import simulator, tick_parts
from tests.support.harness import RunningGraph
from tests.support.pairs import AFTER, MODEL_FREE, Stop, check_equal, go_on, happened, pair, stopped, under_way

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PERIODS = 24


def test_an_answer_of_an_earlier_turn_is_none(tmp_path: Path) -> None:
    """It comes in the next turn of its controller: the other one, which acted meanwhile, knows nothing of it."""
    with pair(tmp_path / "run", law=MODEL_FREE) as robot:
        go_on(robot, 5)
        with under_way(robot, 6, 6):
            go_on(robot, 1)
            with stopped(robot, "controller"):
                go_on(robot, 3)
                assert robot.simulator.tick == 9
                go_on(robot, 3)
                with stopped(robot, "standby"):
                    go_on(robot, 4)
        go_on(robot, 4)
    silent, events = happened(tmp_path / "run")
    assert silent[:3] == [6, 7, 8]
    assert [(kind, node) for _, kind, node in events][:2] == [("acting", "controller"), ("acting", "standby")]
    assert events[-1][1] == "reset"
    check_equal(tmp_path / "run")


@pytest.mark.parametrize("loses", [False, True])
def test_an_answer_that_comes_too_late_begins_the_law_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, loses: bool
) -> None:
    """What it answered is not in the log, nor the reset before it; whether it goes on or the other one takes over."""
    may_be_late(monkeypatch, 2 * AFTER)
    with pair(tmp_path / "run", law=MODEL_FREE) as robot:
        go_on(robot, 5)
        with stopped(robot, "controller"):
            go_on(robot, 6)
        with stopped(robot, "standby"):
            # From now on it is the turn of the first one again, which begins with a reset.
            with under_way(robot, 12):
                go_on(robot, 4 + 3 * AFTER)
                before = robot.simulator.commands.counts["stale"]
            assert robot.simulator.commands.counts["stale"] > before
            go_on(robot, 3)
        if loses:
            with stopped(robot, "controller"):
                go_on(robot, 6)
    _, events = happened(tmp_path / "run")
    assert ("reset", "") in [(kind, node) for _, kind, node in events]
    check_equal(tmp_path / "run")


def test_a_controller_that_is_built_again_begins_with_a_reset(tmp_path: Path) -> None:
    """In its turn, where its law is a new one."""
    with pair(tmp_path / "run") as robot:
        go_on(robot, 5)
        node = robot.nodes["controller"]
        for transition in (node.trigger_deactivate, node.trigger_cleanup, node.trigger_configure):
            node.must(transition)
        node.must(node.trigger_activate)
        robot.settle()
        go_on(robot, 4)
        with stopped(robot, "controller"):
            go_on(robot, 6)
    _, events = happened(tmp_path / "run")
    assert (6, "reset", "") in events
    # The one that stands by has done the same, and takes over as hot as before.
    assert [kind for _, kind, _ in events] == ["acting", "reset", "acting"]
    check_equal(tmp_path / "run")


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_every_order_replays_equal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Nodes that are stopped, answers that are under way and gains that change, at random."""
    may_be_late(monkeypatch, 4)
    random = Random(f"order {seed}")
    with pair(tmp_path / "run", law=MODEL_FREE) as robot:
        stops: dict[str, Stop] = {}
        while robot.simulator.tick < PERIODS:
            what = random.choice(("controller", "standby", "answers", "gains"))
            if what == "gains":
                acting = robot.simulator.commands.accepted.turns.acting
                node = robot.nodes[acting]
                if node._turn.acting == acting:
                    node.tune({"gains.kappa": random.choice((1.0, 1.5, 2.0))})
            elif what in stops:
                stops.pop(what).go_on()
            else:
                stops[what] = Stop(robot, readers(robot, what))
            go_on(robot, random.randint(1, 5))
            assert robot.simulator.end_reason is None
        for stop in stops.values():
            stop.go_on()
    check_equal(tmp_path / "run")


def may_be_late(monkeypatch: pytest.MonkeyPatch, periods: int) -> None:
    """Answers that are later than this act no more."""
    for module in (simulator, tick_parts):
        monkeypatch.setattr(module, "MAX_LATE", periods)


def readers(robot: RunningGraph, what: str) -> list[object]:
    """What hears nothing."""
    return list(robot.simulator.commands.readers if what == "answers" else robot.nodes[what].subscriptions)
