"""Events of a supervisor, field by field: what a log, a ground station and a replay go by."""

from __future__ import annotations

import pytest

from space_robot_msgs_py.events import ERROR, OK, WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Acknowledgement
from space_robot_supervisor import reports
from space_robot_supervisor.monitors import Monitor
from space_robot_supervisor.rows import SEVERITIES, MonitorSpec
from tests.support.supervised import snapshot, supervisor


@pytest.mark.parametrize(("severity", "level"), list(zip(SEVERITIES, (OK, WARN, WARN, ERROR), strict=True)))
def test_a_monitor_says_what_it_read_and_what_its_bounds_are(severity: str, level: int) -> None:
    """It fires at the level of its severity, and what clears is well."""
    bounds = {"above": 1.0, "below": -2.0}
    spec = MonitorSpec.model_validate({"name": "fast", "value": "base.rate", "severity": severity} | bounds)
    monitor = Monitor(spec)
    monitor.seen = 3.5
    values = [("value", "base.rate"), ("is", "3.5"), ("above", "1.0"), ("below", "-2.0"), ("severity", severity)]
    assert reports.edge(7, monitor, "fires") == DiagnosticEvent(7, level, "fast", "fires", "", tuple(values))
    assert reports.edge(8, monitor, "clears") == DiagnosticEvent(8, OK, "fast", "clears", "", tuple(values))


def test_a_mode_comes_with_its_cause() -> None:
    """From where to where, by whom, at the level of the severity that led there."""
    values = (("from", "NOMINAL"), ("to", "SAFE"), ("cause", "fast"))
    expected = DiagnosticEvent(7, ERROR, "mode", "NOMINAL -> SAFE", "", values)
    assert reports.mode(7, "NOMINAL", "SAFE", "fast", "high") == expected


@pytest.mark.parametrize(("accepted", "level", "message"), [(True, OK, "accepted"), (False, WARN, "refused")])
def test_a_command_comes_with_its_answer(accepted: bool, level: int, message: str) -> None:
    """Who gave it, whether it acts, and why."""
    values = (("command", "hold"), ("by", "ground"), ("reason", "because"))
    expected = DiagnosticEvent(7, level, "command", message, "", values)
    assert reports.command(7, "hold", Acknowledgement(accepted, "because"), "ground") == expected


@pytest.mark.parametrize(("how", "level"), [("starts", OK), ("ends", OK), ("aborted", WARN)])
def test_a_sequence_says_what_became_of_it(how: str, level: int) -> None:
    """With its cause where there is one."""
    values = (("sequence", "rest"), ("cause", "fast"))
    assert reports.sequence(7, "rest", how, "fast") == DiagnosticEvent(7, level, "sequence", how, "", values)
    assert reports.sequence(7, "rest", how, "") == DiagnosticEvent(7, level, "sequence", how, "", values[:1])


def test_commands_of_the_ground_are_found_among_events() -> None:
    """All of them in order, accepted or refused, and none of a plan or of another event."""
    yes, no = Acknowledgement(True, ""), Acknowledgement(False, "")
    other = DiagnosticEvent(0, OK, "fast", "fires", "", (("command", "safe"), ("by", "ground")))
    events = [reports.command(0, "hold", yes, "ground"), other, reports.command(0, "safe", yes, "schedule")]
    events += [reports.command(1, "stop", no, "ground"), reports.mode(1, "A", "B", "ground", "info")]
    events.append(DiagnosticEvent(1, OK, "command", "accepted", "", (("by", "ground"),)))
    assert reports.orders_in(events) == ["hold", "stop", ""]
    assert reports.orders_in([]) == []


def test_a_tick_reports_its_command_its_plan_and_its_monitors() -> None:
    """Every event has the stamp of its tick, and names its cause."""
    one = supervisor(
        {"name": "fast", "value": "base.rate", "above": 1.0, "start": "back"},
        modes={"NOMINAL": {}, "STANDBY": {}, "HOLD": {}, "SAFE": {}},
        schedule=[{"at": 1.0, "start": "rest"}, {"at": 1.0, "do": "standby"}],
        sequences={"rest": [{"after": 1.0, "do": "hold"}], "back": [{"after": 9.0, "do": "safe"}]},
    )
    answer = one.order("nominal")
    stamp = 1_000_000_000
    found = [one.update(snapshot(second * stamp, 2.0 * (second == 0))).events for second in range(3)]
    monitor = Monitor(MonitorSpec.model_validate({"name": "fast", "value": "base.rate", "above": 1.0}))
    monitor.seen = 2.0
    assert found[0] == (
        reports.command(0, "nominal", answer, "ground"),
        reports.edge(0, monitor, "fires"),
        reports.sequence(0, "back", "starts", "fast"),
    )
    to_standby = Acknowledgement(True, "from NOMINAL to STANDBY at the next tick")
    assert found[1] == (
        reports.sequence(stamp, "rest", "starts", "schedule"),
        reports.command(stamp, "standby", to_standby, "schedule"),
        reports.mode(stamp, "NOMINAL", "STANDBY", "schedule", "info"),
        reports.sequence(stamp, "back", "aborted", ""),
    )
    to_hold = Acknowledgement(True, "from STANDBY to HOLD at the next tick")
    assert found[2] == (
        reports.command(2 * stamp, "hold", to_hold, "rest"),
        reports.mode(2 * stamp, "STANDBY", "HOLD", "rest", "info"),
        reports.sequence(2 * stamp, "rest", "ends", ""),
    )
