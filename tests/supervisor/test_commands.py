"""Commands of the ground, schedule, sequences and housekeeping of a supervisor, and tables of them that are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_description.actuation import command_limit
from space_robot_description.load import load_robot
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Acknowledgement, Reference, RobotState, Supervision
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.table import SupervisionTable
from space_robot_supervisor.values import Snapshot

MINI = load_robot("mini")
MODES: dict[str, Any] = {
    "STANDBY": {"law": "none"},
    "NOMINAL": {"from": ["STANDBY", "HOLD", "SAFE"]},
    "HOLD": {"reference": "here"},
    "SAFE": {"law": "damped_hold"},
    "STOP": {"law": "damped_hold"},
}
FAST = {"name": "fast", "value": "base.rate", "above": 1.0, "to": "SAFE", "in": ["NOMINAL"]}
RECOVER = [{"after": 2.0, "do": "hold"}, {"after": 4.0, "do": "nominal"}]


def table(**keys: Any) -> SupervisionTable:
    """A checked table."""
    found = validate(SupervisionTable, {"modes": MODES, "monitors": [FAST]} | keys, "supervision.")
    found.check("supervision")
    return found


def supervisor(**keys: Any) -> Supervisor:
    """A supervisor of `mini`."""
    return Supervisor(table(**keys), MINI, (), command_limit(MINI))


def look(one: Supervisor, second: float, rate: float = 0.0) -> Supervision:
    """What it decides on a state at a time, that turns at this rate."""
    q, v = np.array([0, 0, 0, 0, 0, 0, 1.0, *MINI.home]), np.array([0, 0, 0, 0, 0, rate, 0, 0, 0, 0])
    state = RobotState(round(second * NANOSECONDS), q, v, np.zeros(4), np.zeros(3))
    return one.update(Snapshot(state, Reference(state.stamp, q, v, v)))


def said(found: Supervision) -> list[tuple[str, str]]:
    """(name, message) of its events."""
    return [(event.name, event.message) for event in found.events]


def test_a_command_is_answered_at_once_and_acts_at_the_next_tick() -> None:
    """The answer says what will happen; the tick has one event for the command and one for the mode."""
    one = supervisor()
    look(one, 0)
    answer = one.order("safe")
    assert answer.accepted
    assert one.mode == "NOMINAL"
    found = look(one, 1)
    assert (found.mode, found.law, found.since) == ("SAFE", "damped_hold", NANOSECONDS)
    assert said(found) == [("command", "accepted"), ("mode", "NOMINAL -> SAFE")]
    values = dict(found.events[0].values)
    assert (values["command"], values["by"]) == ("safe", "ground")
    assert look(one, 2).events == ()


@pytest.mark.parametrize(
    ("before", "command", "why"),
    [
        ((), "nominal", "in NOMINAL already"),
        (("stop",), "nominal", "not from STOP, but from STANDBY, HOLD, SAFE"),
        ((), "park", "no mode PARK"),
    ],
)
def test_a_command_that_cannot_be_is_refused_with_the_reason(before: tuple[str, ...], command: str, why: str) -> None:
    """Nothing changes but that there is an event; earlier commands of the same tick count."""
    one = supervisor()
    for earlier in before:
        assert one.order(earlier).accepted
    answer = one.order(command)
    assert not answer.accepted
    assert why in answer.reason
    found = look(one, 0)
    assert said(found)[-1] == ("command", "refused")
    assert found.mode == (before[-1].upper() if before else "NOMINAL")


def test_a_command_has_priority_over_monitors() -> None:
    """At the tick of a command that changes the mode no monitor is looked at: they begin in the new mode."""
    one = supervisor()
    one.order("hold")
    assert said(look(one, 0, rate=2.0)) == [("command", "accepted"), ("mode", "NOMINAL -> HOLD")]
    assert look(one, 1, rate=2.0).mode == "HOLD"


def test_what_changes_no_mode_keeps_no_monitor_from_looking() -> None:
    """A refused command or step, or a sequence that starts, costs no tick of the monitors; one that acted does."""
    one = supervisor()
    one.order("nominal")
    assert said(look(one, 0, rate=2.0)) == [("command", "refused"), ("fast", "fires"), ("mode", "NOMINAL -> SAFE")]
    for step in ({"at": 0.0, "do": "nominal"}, {"at": 0.0, "start": "recover"}):
        assert look(supervisor(schedule=[step], sequences={"recover": RECOVER}), 0, rate=2.0).mode == "SAFE"
    everywhere = [{"name": "everywhere", "value": "base.rate", "above": 1.0}]
    one = supervisor(monitors=everywhere)
    assert (one.order("hold").accepted, one.order("hold").accepted) == (True, False)
    events = [("command", "accepted"), ("mode", "NOMINAL -> HOLD"), ("command", "refused")]
    assert said(look(one, 0, rate=2.0)) == events
    schedule = [{"at": 0.0, "do": "hold"}, {"at": 0.0, "do": "hold"}]
    one = supervisor(monitors=everywhere, schedule=schedule)
    assert said(look(one, 0, rate=2.0)) == events
    assert said(look(one, 1, rate=2.0)) == [("everywhere", "fires")]
    one = supervisor(monitors=everywhere, schedule=[{"at": 0.0, "do": "hold"}])
    one.order("hold")
    assert said(look(one, 0, rate=2.0)) == events


def test_only_commands_of_the_ground_lead_to_modes() -> None:
    """A mode of another name is reached by monitors alone."""
    odd = {"name": "odd", "value": "base.rate", "above": 9.0, "to": "PARK", "in": ["NOMINAL"], "severity": "high"}
    one = supervisor(modes=MODES | {"PARK": {}}, monitors=[odd])
    assert not one.order("park").accepted
    assert one.order("hold") == Acknowledgement(True, "from NOMINAL to HOLD at the next tick")


def test_a_schedule_acts_at_the_first_tick_at_or_after_its_time() -> None:
    """As a command of the ground would, by the schedule."""
    one = supervisor(schedule=[{"at": 1.5, "do": "hold"}, {"at": 3.0, "do": "nominal"}])
    found = [look(one, second) for second in range(5)]
    assert [tick.mode for tick in found] == ["NOMINAL", "NOMINAL", "HOLD", "NOMINAL", "NOMINAL"]
    assert dict(found[2].events[0].values)["by"] == "schedule"


def test_a_monitor_starts_a_sequence() -> None:
    """Its steps are timed from the start and reported; the mode that the monitor leads to does not abort it."""
    one = supervisor(monitors=[FAST | {"start": "recover"}], sequences={"recover": RECOVER})
    found = [look(one, second, rate=2.0 * (second == 1)) for second in range(7)]
    assert [tick.mode for tick in found] == ["NOMINAL", "SAFE", "SAFE", "HOLD", "HOLD", "NOMINAL", "NOMINAL"]
    assert said(found[1]) == [("fast", "fires"), ("sequence", "starts"), ("mode", "NOMINAL -> SAFE")]
    assert said(found[5]) == [("command", "accepted"), ("mode", "HOLD -> NOMINAL"), ("sequence", "ends")]


def test_another_change_of_mode_aborts_a_sequence() -> None:
    """What was planned in one mode is not done in another."""
    one = supervisor(schedule=[{"at": 0.0, "start": "recover"}], sequences={"recover": RECOVER})
    assert said(look(one, 0)) == [("sequence", "starts")]
    one.order("stop")
    assert said(look(one, 1))[-1] == ("sequence", "aborted")
    assert [look(one, second).mode for second in range(2, 6)] == ["STOP"] * 4


def test_a_step_that_is_refused_aborts_its_sequence() -> None:
    """The rest of it is not done."""
    one = supervisor(schedule=[{"at": 0.0, "start": "again"}], sequences={"again": [{"after": 1, "do": "nominal"}]})
    look(one, 0)
    assert said(look(one, 1)) == [("command", "refused"), ("sequence", "aborted")]


def test_housekeeping_has_its_own_period() -> None:
    """Mode, number of events and the named values, every so many seconds; what is not there yet is empty."""
    one = supervisor(housekeeping={"period": 2.0, "values": ["base.rate", "command.saturation"]})
    found = [look(one, second, rate=2.0).housekeeping for second in range(4)]
    assert [summary is None for summary in found] == [False, True, False, True]
    one.order("hold")
    look(one, 5)
    one.order("hold")
    last = look(one, 6).housekeeping
    # A command and a mode at 5 s, a command that was refused at 6 s.
    assert last is not None
    assert last["events"].item() == 5.0
    first, third = found[0], found[2]
    assert first is not None
    assert third is not None
    assert first.labels == ("mode", "events", "base.rate", "command.saturation")
    assert first.sizes == (1, 1, 1, 0)
    assert third["mode"].item() == list(MODES).index("SAFE")
    assert (first.stamp, third.stamp) == (0, 2 * NANOSECONDS)
    # What fired at tick 0 and the mode it led to; nothing since.
    assert (first["events"].item(), third["events"].item()) == (2.0, 2.0)
    assert third["base.rate"].item() == 2.0


def test_a_reset_forgets_orders_and_plans() -> None:
    """A run begins with the schedule from its start."""
    one = supervisor(schedule=[{"at": 1.0, "do": "hold"}])
    look(one, 1)
    one.order("stop")
    one.reset()
    assert [look(one, second).mode for second in range(2)] == ["NOMINAL", "HOLD"]


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ({"schedule": [{"at": 1.0}]}, "supervision.schedule.0"),
        (
            {"schedule": [{"at": 1.0, "do": "hold", "start": "a"}], "sequences": {"a": RECOVER}},
            "supervision.schedule.0",
        ),
        ({"schedule": [{"at": 1.0, "do": "park"}]}, "supervision.schedule.0.do"),
        ({"schedule": [{"at": 1.0, "start": "rest"}]}, "supervision.schedule.0.start"),
        ({"schedule": [{"at": 2.0, "do": "hold"}, {"at": 1.0, "do": "safe"}]}, "supervision.schedule.1"),
        ({"monitors": [FAST | {"start": "rest"}]}, "supervision.monitors.0.start"),
        ({"monitors": [FAST | {"name": "mode"}]}, "supervision.monitors.0.name"),
        ({"modes": {"NOMINAL": {}, "SAFE": {}}, "schedule": [{"at": 1.0, "do": "stop"}]}, "supervision.schedule.0.do"),
        ({"modes": MODES | {"STOP": {"from": ["NOWHERE"]}}}, "supervision.modes.STOP.from"),
        ({"housekeeping": {"period": 0.0}}, "supervision.housekeeping.period"),
    ],
)
def test_plans_that_cannot_be_are_refused(keys: dict[str, Any], key: str) -> None:
    """With the key, before anything runs."""
    with pytest.raises(SpecError) as caught:
        table(**keys)
    assert caught.value.key == key


def test_counts_need_the_monitor_of_the_plant() -> None:
    """Without it nothing counts, and the table is refused."""
    row = {"name": "lost", "value": "command.missed", "above": 3}
    with pytest.raises(SpecError, match=r"plant\.monitor"):
        supervisor(monitors=[row])
    Supervisor(table(monitors=[row]), MINI, (), command_limit(MINI), counted=True)
