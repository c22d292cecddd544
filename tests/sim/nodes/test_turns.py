"""Of two controllers one acts at a time."""

from __future__ import annotations

from space_robot_sim.nodes.turns import PATIENCE, Turns


def test_a_turn_changes_after_so_many_silent_periods_in_a_row() -> None:
    """An answer in between begins to count again; who takes over has more time for its first answer."""
    turns, acting = Turns(2), []
    for answered in (1, 0, 1, 0, 0, 0, 1, 0, 0):
        turns.answer() if answered else turns.pass_by()
        acting.append(turns.acting)
    assert acting == ["controller"] * 4 + ["standby"] * 4 + ["controller"]
    assert turns.answered == 3
    for silent in range(PATIENCE * 2):
        assert turns.acting == "controller", silent
        turns.pass_by()
    assert turns.acting == "standby"


def test_a_node_is_known_by_its_name_in_any_namespace() -> None:
    """Whatever else it is called, and nothing without a name."""
    turns = Turns(1)
    assert turns.admits("/robot1/controller")
    assert not any(map(turns.admits, ("/standby", "/my_controller", "")))
    turns.pass_by()
    assert turns.admits("/standby")
