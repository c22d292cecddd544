"""The supervisor: monitors with persistence, hysteresis and inhibition, modes, references, tables that are refused."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
import pytest

from space_robot_description.actuation import command_limit
from space_robot_description.load import load_robot
from space_robot_description.rotations import normalized, relative
from space_robot_description.share import config_dir, shipped
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import ERROR, OK, WARN
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Supervision, Telemetry
from space_robot_msgs_py.kernel.elementary import atan2
from space_robot_supervisor.reader import Reader
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.table import SupervisionTable
from space_robot_supervisor.values import Snapshot, value_of, values_of
from tests.support.supervised import FAST, MINI, MODES, reported, snapshot, supervisor, table, watched
from tests.support.values import bits


def test_a_monitor_fires_when_its_condition_has_held_long_enough() -> None:
    """Three periods in a row above, not two and one later; the mode changes at that tick, with an event for each."""
    found = watched(supervisor(FAST | {"for": 3, "severity": "high"}), [2, 2, 0, 2, 2, 2, 0])
    assert reported(found, "fast") == [(5, "fires")]
    assert reported(found, "mode") == [(5, "NOMINAL -> SAFE")]
    assert [one.mode for one in found] == ["NOMINAL"] * 5 + ["SAFE"] * 2
    fires, mode = found[5].events
    assert (fires.level, mode.level, fires.stamp) == (ERROR, ERROR, 5)
    expected = {"value": "base.rate", "is": "2.0", "above": "1.0", "severity": "high"}
    assert dict(fires.values) == expected
    assert dict(mode.values) == {"from": "NOMINAL", "to": "SAFE", "cause": "fast"}


def test_hysteresis_keeps_a_monitor_from_chattering() -> None:
    """Around the threshold it fires once; it clears below threshold less hysteresis, and may then fire again."""
    row = {"name": "fast", "value": "base.rate", "above": 1.0, "hysteresis": 0.2}
    found = watched(supervisor(row, modes={"NOMINAL": {}}), [1.1, 0.9, 1.1, 0.9, 0.7, 0.9, 1.1])
    assert reported(found, "fast") == [(0, "fires"), (4, "clears"), (6, "fires")]
    assert [event.level for one in found for event in one.events] == [WARN, OK, WARN]


def test_inhibition_silences_a_monitor_after_it_fired() -> None:
    """For so many periods it neither fires nor clears."""
    row = {"name": "fast", "value": "base.rate", "above": 1.0, "inhibit_after": 3}
    found = watched(supervisor(row, modes={"NOMINAL": {}}), [2, 0, 2, 0, 0, 2])
    assert reported(found, "fast") == [(0, "fires"), (4, "clears"), (5, "fires")]


def test_a_monitor_fires_so_often_and_no_more() -> None:
    """Whatever the mode in between; a reset begins to count again."""
    back = {"name": "still", "value": "base.rate", "below": 0.1, "in": ["SAFE"], "to": "NOMINAL", "times": 1}
    one, rates = supervisor(FAST, back), [2.0, 0.0, 2.0, 0.0, 0.0]
    for _ in range(2):
        found = watched(one, rates)
        assert reported(found, "mode") == [(0, "NOMINAL -> SAFE"), (1, "SAFE -> NOMINAL"), (2, "NOMINAL -> SAFE")]
        one.reset()


def test_a_frozen_reading_is_unchanged() -> None:
    """The same number, to the bit, so many times in a row."""
    row = {"name": "frozen", "value": "rate.z", "unchanged": True, "for": 2}
    found = watched(supervisor(row, modes={"NOMINAL": {}}), [0.1, 0.2, 0.2, 0.2, 0.3, 0.3])
    assert reported(found, "frozen") == [(3, "fires"), (4, "clears")]


def test_a_band_has_two_edges() -> None:
    """Above and below together are outside of a band."""
    row = {"name": "outside", "value": "rate.z", "above": 1.0, "below": -1.0}
    found = watched(supervisor(row, modes={"NOMINAL": {}}), [0.0, -2.0, 0.0, 2.0])
    assert reported(found, "outside") == [(1, "fires"), (2, "clears"), (3, "fires")]


def test_the_highest_severity_decides() -> None:
    """Of two that fire at once the higher one leads; both are reported."""
    modes = MODES | {"HOLD": {"reference": "freeze"}}
    low = FAST | {"name": "low", "to": "HOLD", "severity": "low"}
    found = watched(supervisor(low, FAST | {"severity": "high"}, modes=modes), [2.0])
    assert [event.name for event in found[0].events] == ["low", "fast", "mode"]
    assert found[0].mode == "SAFE"


def test_a_decision_has_everything_that_holds_from_its_stamp_on() -> None:
    """Law, reference and brakes of the mode, since when it holds, and which answer of the controller was known."""
    safe = {"law": "damped_hold", "reference": "here", "brakes": True}
    one = supervisor(FAST, modes={"NOMINAL": {"reference": "freeze"}, "SAFE": safe})
    first = one.update(snapshot(0))
    assert bits(first) == bits(Supervision(0, "NOMINAL", "controller", "freeze", 0, -1, (), None, False))
    command = Command(3, np.zeros(6), np.zeros(4))
    found = one.update(snapshot(5, 2.0, command=command))
    assert bits(found) == bits(Supervision(5, "SAFE", "damped_hold", "here", 5, 3, found.events, None, True))
    assert len(found.events) == 2
    later = one.update(snapshot(6, 2.0, command=command))
    assert bits(later) == bits(Supervision(6, "SAFE", "damped_hold", "here", 5, 3, (), None, True))


def test_of_equal_severities_the_first_row_decides() -> None:
    """Rows on different values may fire at once; a later one of a higher severity decides all the same."""
    modes = MODES | {"HOLD": {"reference": "freeze"}}
    other = {"name": "other", "value": "rate.z", "above": 1.0, "to": "HOLD"}
    for rows, mode in (
        ((FAST, other), "SAFE"),
        ((other, FAST), "HOLD"),
        ((FAST, other | {"severity": "high"}), "HOLD"),
    ):
        found = watched(supervisor(*rows, modes=modes), [2.0])[0]
        assert [event.name for event in found.events] == [*(row["name"] for row in rows), "mode"]
        assert found.mode == mode


def test_a_row_that_finds_nothing_keeps_no_other_from_looking() -> None:
    """Rows with nothing to see, with nothing new, or without a number stand before and behind the one that fires."""
    rate = {"value": "base.rate", "above": 1.0}
    rows = [
        {"name": "unknown", "value": "command.saturation", "above": 0.5},
        {"name": "calm", "value": "base.rate", "above": 99.0},
        rate | {"name": "patient", "for": 9},
        rate | {"name": "fast"},
        {"name": "slow", "value": "base.rate", "above": 1.5},
        {"name": "still", "value": "base.rate", "below": 0.1},
    ]
    found = watched(supervisor(*rows, modes={"NOMINAL": {}}), [0.0, 1.2, 2.0, 1.2, 0.0])
    expected = {"fast": [(1, "fires"), (4, "clears")], "slow": [(2, "fires"), (3, "clears")]}
    expected["still"] = [(0, "fires"), (1, "clears"), (4, "fires")]
    for name in ("unknown", "calm", "patient", "fast", "slow", "still"):
        assert reported(found, name) == expected.get(name, []), name


def test_what_clears_starts_nothing() -> None:
    """A sequence is started by the row that fires, once for each time."""
    row = {"name": "fast", "value": "base.rate", "above": 1.0, "start": "rest"}
    one = supervisor(row, modes=MODES | {"HOLD": {}}, sequences={"rest": [{"after": 9.0, "do": "hold"}]})
    found = watched(one, [2.0, 0.0, 0.0, 2.0])
    assert reported(found, "fast") == [(0, "fires"), (1, "clears"), (3, "fires")]
    assert reported(found, "sequence") == [(0, "starts"), (3, "starts")]


def test_monitors_count_from_zero_in_another_mode() -> None:
    """A row is looked at in its modes only, and begins to count when one of them begins."""
    back = {
        "name": "still",
        "value": "base.rate",
        "below": 0.1,
        "for": 3,
        "in": ["SAFE"],
        "to": "NOMINAL",
        "severity": "info",
    }
    found = watched(supervisor(FAST, back), [0, 0, 0, 2, 0, 0, 0, 0])
    assert reported(found, "still") == [(6, "fires")]
    assert reported(found, "mode") == [(3, "NOMINAL -> SAFE"), (6, "SAFE -> NOMINAL")]


def test_a_reset_forgets() -> None:
    """The same run again gives the same events."""
    one, rates = supervisor(FAST | {"for": 2}), [2.0, 2.0, 0.0]
    first = watched(one, rates)
    one.reset()
    again = watched(one, rates)
    assert [found.events for found in again] == [found.events for found in first]


def test_values_are_those_of_the_flight_software() -> None:
    """Rates, errors, telemetry by label, saturation of the last command; what is not there yet is no number."""
    now, labels = snapshot(3, 0.5), ("gain", "SAFE.gain")

    def read(name: str, at: Snapshot) -> float | None:
        reader = Reader([value_of(name, MINI, labels, "k")], MINI, command_limit(MINI))
        assert not reader.read(at)
        return reader.found[0][1]

    assert read("base.rate", now) == 0.5
    margin = np.minimum(MINI.home - MINI.joint_lower, MINI.joint_upper - MINI.home)
    assert read("joints.margin", now) == pytest.approx(margin.min())
    assert read("error.position", now) == pytest.approx(np.hypot(3, 3))
    assert read("command.saturation", now) is None
    assert read("telemetry.gain", now) is None
    effort = np.where(np.arange(4) == 1, MINI.effort_limit, 0.0)
    later = snapshot(4, command=Command(3, np.zeros(6), effort), telemetry=Telemetry.of(3, {"gain": [1.0, -2.0]}))
    assert read("command.saturation", later) == pytest.approx(1 / 7)
    assert read("telemetry.gain", later) == 2.0
    assert read("telemetry.gain.0", later) == 1.0
    assert read("telemetry.gain.7", later) is None
    assert read("telemetry.SAFE.gain", later) is None


def test_values_are_the_formulas_of_the_page_to_the_bit() -> None:
    """Compiled or not: what is in the log of one machine is in that of another."""
    rng, names = np.random.default_rng(1), [*values_of(MINI)]
    reader = Reader([value_of(name, MINI, (), "k") for name in names], MINI, command_limit(MINI))
    for tick in range(200):
        q, q_d = (np.r_[rng.normal(size=3), normalized(rng.normal(size=4)), rng.normal(size=4)] for _ in range(2))
        v = rng.normal(size=10)
        state = RobotState(tick, q, v, np.zeros(4), np.zeros(3))
        reader.read(Snapshot(state, Reference(tick, q_d, v, v), wheels=v[:3]))
        found = dict(zip(names, (now for _, now in reader.found), strict=True))
        x, y, z, w = relative(q[3:7], q_d[3:7])
        assert found["error.attitude"] == 2.0 * atan2(sqrt(x * x + y * y + z * z), w)
        assert found["joints.margin"] == min(*(q[7:] - MINI.joint_lower), *(MINI.joint_upper - q[7:]))
        assert found["error.joints"] == max(abs(q_d[7:] - q[7:]))
        assert found["joints.rate"] == max(abs(v[6:]))
        assert found["rate.y"] == v[4]
        assert found["attitude.w"] == q[6]


def test_a_mode_without_monitors_reads_nothing() -> None:
    """Whatever there is to be read."""
    one = supervisor()
    later = snapshot(1, 9.0, command=Command(0, np.zeros(6), np.zeros(4)), telemetry=Telemetry.of(0, {"gain": [1.0]}))
    assert [one.update(at).events for at in (snapshot(0, 9.0), later)] == [(), ()]


def test_a_tick_that_needs_no_closer_look_is_one_at_which_none_would_find_anything() -> None:
    """Looking closely at every tick finds the same events: of rows with persistence, hysteresis, inhibition, bands."""
    rows = [
        {"name": "fast", "value": "base.rate", "above": 1.0, "hysteresis": 0.3, "for": 2, "inhibit_after": 3},
        {"name": "frozen", "value": "rate.z", "unchanged": True, "for": 2},
        {"name": "outside", "value": "rate.z", "above": 0.8, "below": 0.2, "times": 9},
        FAST | {"name": "faster", "above": 1.6, "for": 2},
        {"name": "still", "value": "base.rate", "below": 0.4, "for": 2, "in": ["SAFE"], "to": "NOMINAL"},
    ]
    rates = np.round(np.random.default_rng(2).uniform(0.0, 2.0, 400), 1).tolist()
    quick, close = supervisor(*rows), supervisor(*rows)
    found = watched(quick, rates)
    with pytest.MonkeyPatch.context() as patch:
        read = Reader.read
        patch.setattr(Reader, "read", lambda reader, now: read(reader, now) + 1)
        expected = watched(close, rates)
    assert len([event for one in found for event in one.events]) > 80
    assert [(one.mode, one.events) for one in found] == [(one.mode, one.events) for one in expected]


@pytest.mark.parametrize(
    ("monitors", "keys", "key", "said"),
    [
        ([], {"modes": {}}, "supervision.modes", ""),
        ([], {"start": "NOMINL"}, "supervision.start", "NOMINAL"),
        ([], {"modes": MODES | {"ASLEEP": {}}}, "supervision.modes.ASLEEP", "never reached"),
        ([FAST | {"to": "SAVE"}], {}, "supervision.monitors.0.to", "SAFE"),
        ([FAST | {"in": ["NOMNAL"]}], {}, "supervision.monitors.0.in", "NOMINAL"),
        ([FAST | {"in": ["NOMINAL", "SAFE"]}], {}, "supervision.monitors.0.in", "leads to a mode"),
        ([FAST, FAST], {}, "supervision.monitors.1.name", "of that name"),
        ([FAST | {"above": None}], {}, "supervision.monitors.0", "say above, below"),
        ([FAST | {"unchanged": True}], {}, "supervision.monitors.0", "say above, below"),
        ([FAST | {"below": 2.0}], {}, "supervision.monitors.0", "outside"),
        ([FAST | {"times": 0}], {}, "supervision.monitors.0.times", ""),
        ([FAST], {"fallback": "SAVE"}, "supervision.fallback", "SAFE"),
        ([FAST], {"fallback": "NOMINAL"}, "supervision.fallback", "a law of its own"),
        ([FAST | {"hysterese": 1.0}], {}, "supervision.monitors.0.hysterese", "hysteresis"),
        ([FAST], {"modes": MODES | {"NOMINAL": {"gains": {"rate": 1.0}}}}, "supervision.modes.NOMINAL", "experiment"),
        (
            [FAST, FAST | {"name": "b", "above": 2.0, "to": "HOLD"}],
            {"modes": MODES | {"HOLD": {}}},
            "supervision.monitors",
            "contradicts 'fast'",
        ),
        (
            [FAST, {"name": "b", "value": "base.rate", "below": 1.5, "in": ["SAFE"], "to": "NOMINAL"}],
            {},
            "supervision.monitors",
            "leads back",
        ),
    ],
)
def test_tables_that_cannot_be_are_refused(
    monitors: list[dict[str, Any]], keys: dict[str, Any], key: str, said: str
) -> None:
    """One line with the key: missing modes, unreachable ones, contradictions, flapping, conditions that are none."""
    with pytest.raises(SpecError) as caught:
        table(*monitors, **keys)
    assert caught.value.key == key
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", ["base.rte", "telemetry.eror", "joint.rate.joint9", "momentum"])
def test_a_value_that_is_not_there_is_refused(value: str) -> None:
    """With the key of its row and the nearest names."""
    with pytest.raises(SpecError) as caught:
        supervisor(FAST | {"value": value})
    assert caught.value.key == "supervision.monitors.0.value"
    assert caught.value.accepted


@pytest.mark.parametrize("name", shipped("supervision"))
def test_shipped_tables_are_sound(name: str) -> None:
    """They begin with the name of their robot, check, and read values that it has."""
    robot = load_robot(name.partition("_")[0])
    found = validate(SupervisionTable, parse_yaml(config_dir() / "supervision" / f"{name}.yaml"), name)
    found.check("supervision")
    Supervisor(found, robot, ("law_failed",), command_limit(robot))
    assert found.title
