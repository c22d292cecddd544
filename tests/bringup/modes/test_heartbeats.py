"""Heartbeats of processes, and the plan by which they are killed and stopped."""

from __future__ import annotations

from space_robot_bringup.modes.chaos import ACTIONS, BLOWS, plan
from space_robot_bringup.modes.heartbeats import SILENT_SECONDS, Heartbeats
from space_robot_bringup.modes.hooks import roles_of


class Clock:
    """Goes on when the test says so."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def beats_of(*roles: str) -> tuple[Heartbeats, Clock]:
    """Heartbeats that heard these at 0 s."""
    clock = Clock()
    beats = Heartbeats(clock)
    for role in roles:
        beats.hear(role)
    return beats, clock


def looked(beats: Heartbeats, clock: Clock, until: float) -> list[str]:
    """What is silent at the end, asked often on the way."""
    found: list[str] = []
    while clock.now < until:
        clock.now += 0.05
        found = beats.silent()
    return found


def test_a_process_is_silent_after_so_long() -> None:
    """Not before, and not after it was heard again or is gone."""
    beats, clock = beats_of("guidance", "simulator", "recorder")
    assert looked(beats, clock, SILENT_SECONDS - 0.1) == []
    beats.hear("simulator")
    beats.forget("recorder")
    assert looked(beats, clock, SILENT_SECONDS + 0.1) == ["guidance"]


def test_who_was_stopped_itself_misses_no_others() -> None:
    """A parent that was stopped gives its processes as long again."""
    beats, clock = beats_of("guidance")
    clock.now = 10.0
    assert beats.silent() == []
    assert looked(beats, clock, 10.0 + SILENT_SECONDS + 0.1) == ["guidance"]


def test_a_plan_is_its_seeds() -> None:
    """The same again, in the order of time; of two controllers only they are killed, alone none is started again."""
    pair, alone = roles_of(supervised=True, failover=True), roles_of(supervised=False)
    assert plan(1, 400, pair) == plan(1, 400, pair) != plan(2, 400, pair)
    both = [blow for seed in range(100) for blow in plan(seed, 400, pair)]
    assert len(both) == 100 * BLOWS
    assert {blow.action for blow in both} == set(ACTIONS)
    assert {blow.role for blow in both if blow.action != "stop"} == {"controller", "standby"}
    assert {blow.role for blow in both if blow.action == "stop"} == set(pair)
    single = [blow for seed in range(100) for blow in plan(seed, 400, alone)]
    assert {blow.action for blow in single} == {"kill", "stop"}
    assert all(0 < blow.tick < 400 for blow in both + single)
