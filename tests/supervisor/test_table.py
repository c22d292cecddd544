"""Tables that contradict themselves, and near relatives of them that do not."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpecError
from space_robot_supervisor.table import SupervisionTable

MODES: dict[str, Any] = {"NOMINAL": {}, "SAFE": {"law": "damped_hold"}, "HOLD": {"reference": "here"}}
BOUNDS: tuple[dict[str, float | bool], ...] = (
    {"above": 1.0},
    {"above": 2.0},
    {"below": 1.0},
    {"below": 2.0},
    {"above": 2.0, "below": 1.0},
    {"above": 1.0, "below": -1.0},
    {"unchanged": True},
)
PAIRS = list(product(BOUNDS, BOUNDS))


def check(*monitors: dict[str, Any], **keys: Any) -> SupervisionTable:
    """A table that is checked."""
    found = validate(SupervisionTable, {"modes": MODES, "monitors": list(monitors)} | keys, "table.")
    found.check("table")
    return found


def refusal(*monitors: dict[str, Any], **keys: Any) -> SpecError | None:
    """Why a table is refused; None: it is not."""
    try:
        check(*monitors, **keys)
    except SpecError as error:
        return error
    return None


def row(name: str, to: str | None, bound: dict[str, Any], **keys: Any) -> dict[str, Any]:
    """A row that reads a rate."""
    return {"name": name, "value": "base.rate", "to": to} | bound | keys


def both_may_hold(first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Some number is beyond a bound of each; bounds say nothing of what does not change."""
    if "unchanged" in first or "unchanged" in second:
        return "unchanged" in first and "unchanged" in second

    def holds(bound: dict[str, Any], value: float) -> bool:
        return value > bound.get("above", float("inf")) or value < bound.get("below", -float("inf"))

    return any(holds(first, value) and holds(second, value) for value in (-9.0, 0.0, 1.0, 1.5, 2.0, 9.0))


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_two_rows_must_not_lead_to_two_modes_at_once(first: dict[str, Any], second: dict[str, Any]) -> None:
    """Refused where some value fulfils both; not with another severity, of another value, or in other modes."""
    one, other = row("a", "SAFE", first, **{"in": ["NOMINAL"]}), row("b", "HOLD", second, **{"in": ["NOMINAL"]})
    error = refusal(one, other)
    assert (error is not None) is both_may_hold(first, second)
    if error is not None:
        assert (error.key, error.value) == ("table.monitors", "b")
        assert "contradicts 'a': in NOMINAL both may hold" in str(error)
    apart = {"modes": MODES | {"STANDBY": {}}}
    assert refusal(one, other | {"severity": "high"}) is None
    assert refusal(one, other | {"to": "SAFE"}) is None
    assert refusal(one, other | {"value": "base.speed"}) is None
    assert refusal(one, other | {"in": ["STANDBY"]}, **apart) is None


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_two_rows_must_not_lead_to_and_fro(first: dict[str, Any], second: dict[str, Any]) -> None:
    """A value that leads to a mode must not lead back from it; one that leads on, or from elsewhere, may."""
    there = row("a", "SAFE", first, **{"in": ["NOMINAL"]})
    back = row("b", "NOMINAL", second, **{"in": ["SAFE"]})
    error = refusal(there, back)
    assert (error is not None) is both_may_hold(first, second)
    if error is not None:
        assert (error.key, error.value) == ("table.monitors", "b")
        assert "leads back from where 'a' leads to" in str(error)
    assert refusal(there, back | {"to": "HOLD"}) is None
    assert refusal(there, back | {"in": ["HOLD"]}) is None


def test_a_row_without_modes_is_looked_at_in_all_but_its_own() -> None:
    """And counts as such for what contradicts it."""
    table = check(row("a", "SAFE", {"above": 1.0}), row("b", None, {"above": 1.0}))
    assert [table.modes_of(one) for one in table.monitors] == [("NOMINAL", "HOLD"), ("NOMINAL", "SAFE", "HOLD")]
    error = refusal(row("a", "SAFE", {"above": 1.0}), row("b", "HOLD", {"above": 1.0}))
    assert error is not None
    assert "in NOMINAL" in str(error)


@pytest.mark.parametrize(
    ("modes", "monitors", "unreached"),
    [
        ({"NOMINAL": {}, "ODD": {}}, [], "ODD"),
        ({"NOMINAL": {}, "ODD": {}}, [row("a", "ODD", {"above": 1.0})], None),
        ({"NOMINAL": {}, "ODD": {}, "EVEN": {}}, [row("a", "ODD", {"above": 1.0}, **{"in": ["EVEN"]})], "ODD"),
        (
            {"NOMINAL": {}, "ODD": {}, "EVEN": {}},
            [row("a", "ODD", {"above": 1}, **{"in": ["NOMINAL"]}), row("b", "EVEN", {"below": 1}, **{"in": ["ODD"]})],
            None,
        ),
        ({"NOMINAL": {}, "STOP": {}}, [], None),
        ({"NOMINAL": {}, "stop": {}}, [], "stop"),
        ({"NOMINAL": {}, "STOP": {"from": ["SAFE"]}, "SAFE": {"from": ["STOP"]}}, [], "STOP"),
        ({"NOMINAL": {}, "STOP": {"from": ["SAFE"]}, "SAFE": {"from": ["NOMINAL"]}}, [], None),
        ({"NOMINAL": {}, "ODD": {"from": ["NOMINAL"]}}, [], "ODD"),
    ],
)
def test_every_mode_is_reached(modes: dict[str, Any], monitors: list[dict[str, Any]], unreached: str | None) -> None:
    """By rows or commands, step by step from the first one."""
    error = refusal(*monitors, modes=modes)
    assert (None if error is None else error.key) == (None if unreached is None else f"table.modes.{unreached}")


def test_times_of_steps_may_be_equal_and_may_not_go_back() -> None:
    """Within the schedule, and within each sequence; commands need their mode."""
    step = {"at": 1.0, "do": "hold"}
    assert refusal(schedule=[step, step]) is None
    rest = [{"after": 1.0, "do": "hold"}, {"after": 0.5, "do": "safe"}]
    error = refusal(sequences={"fine": rest[::-1], "rest": rest})
    assert error is not None
    assert (error.key, error.value) == ("table.sequences.rest.1", 0.5)
    error = refusal(sequences={"rest": [{"after": 1.0, "do": "stop"}]})
    assert error is not None
    assert (error.key, error.value) == ("table.sequences.rest.0.do", "STOP")


def test_a_sequence_that_is_started_has_to_be_there() -> None:
    """The refusal names the nearest one, all of them, or the section."""
    rest = [{"after": 1.0, "do": "hold"}]
    for sequences, accepted in (
        ({}, "a section sequences"),
        ({"rest": rest}, "rest"),
        ({"abc": rest, "xyz": rest}, "abc, xyz"),
    ):
        error = refusal(row("a", None, {"above": 1.0}, start="rost"), sequences=sequences)
        assert error is not None
        assert (error.key, error.value, error.accepted) == ("table.monitors.0.start", "rost", accepted)


def test_only_a_mode_with_a_law_of_its_own_falls_back() -> None:
    """A fallback answers where the law of the experiment does not."""
    assert refusal(fallback="SAFE") is None
    assert refusal() is None
    error = refusal(fallback="HOLD")
    assert error is not None
    assert (error.key, error.value) == ("table.fallback", "HOLD")


def test_a_table_says_whether_some_mode_brakes() -> None:
    """One is enough."""
    assert not check().brakes
    assert check(modes=MODES | {"HOLD": {"brakes": True}}).brakes
