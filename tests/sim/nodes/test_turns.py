"""Of two controllers one acts at a time."""

from __future__ import annotations

import pytest

from space_robot_sim.nodes.turns import PATIENCE, Turns

PERIOD = 10


def turns_after(periods: int, *answered: int) -> Turns:
    """Turns after so many periods as there are numbers, of which 1 is one with an answer."""
    turns = Turns(periods, PERIOD)
    for tick, one in enumerate(answered):
        turns.answer(tick * PERIOD) if one else turns.pass_by(tick * PERIOD)
    return turns


def test_a_turn_changes_after_so_many_silent_periods_in_a_row() -> None:
    """An answer in between begins to count again; who takes over has more time for its first answer."""
    turns, acting = Turns(2, PERIOD), []
    for tick, answered in enumerate((1, 0, 1, 0, 0, 0, 1, 0, 0)):
        turns.answer(tick * PERIOD) if answered else turns.pass_by(tick * PERIOD)
        acting.append(turns.acting)
    assert acting == ["controller"] * 4 + ["standby"] * 4 + ["controller"]
    assert turns.answered == 3
    for silent in range(PATIENCE * 2):
        assert turns.acting == "controller", silent
        turns.pass_by((9 + silent) * PERIOD)
    assert turns.acting == "standby"


def test_a_node_is_known_by_its_name_in_any_namespace() -> None:
    """Whatever else it is called, and nothing without a name."""
    turns = Turns(1, PERIOD)
    assert not turns.refusal("/robot1/controller", 0)
    assert all(turns.refusal(name, 0) == "it is the turn of controller" for name in ("/standby", "/my_controller", ""))
    turns.pass_by(0)
    assert not turns.refusal("/standby", PERIOD)


@pytest.mark.parametrize(("stamp", "refused"), [(2, True), (3, True), (4, False), (5, False)])
def test_only_states_of_the_turn_are_answered(stamp: int, refused: bool) -> None:
    """Those from the end of the period on at which it began: an answer from before is none, however late it comes."""
    turns = turns_after(3, 1, 0, 0, 0)
    assert (turns.acting, turns.since) == ("standby", 4 * PERIOD)
    assert bool(turns.refusal("/standby", stamp * PERIOD)) == refused


def test_states_are_answered_in_their_order() -> None:
    """Of what a controller that was killed has sent, and of the one in its place, the older one comes too late."""
    turns = turns_after(3, 1, 0, 1)
    assert "is answered, which is newer" in turns.refusal("/controller", PERIOD)
    assert not turns.refusal("/controller", 2 * PERIOD)


def test_an_answer_that_comes_too_late_begins_the_turn_anew() -> None:
    """Its controller acts still, from the state on before which it hears of that."""
    turns = turns_after(3, 1, 0, 0)
    turns.restart_turn(3 * PERIOD)
    assert (turns.acting, turns.since, turns.answered) == ("controller", 4 * PERIOD, 1)
    for tick in (3, 4):
        turns.pass_by(tick * PERIOD)
    assert turns.acting == "controller"
    turns.pass_by(5 * PERIOD)
    assert (turns.acting, turns.since) == ("standby", 6 * PERIOD)
