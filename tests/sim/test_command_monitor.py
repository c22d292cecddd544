"""The plant's checks of commands: what is refused, clipped, counted and reported."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_description.actuation import command_limit
from space_robot_msgs_py.events import WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.command_monitor import CLIPPED, MISSING, REFUSED, CommandMonitor
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import HoldFor, MonitorSpec
from tests.support.robots import arm_model, robot_of

LIMIT = np.array([np.inf, np.inf, np.inf, 2.0, 2.0, 2.0, 10.0, 5.0])
NAMES = ("shoulder", "elbow")


def monitor(**checks: Any) -> CommandMonitor:
    """A monitor with these checks."""
    return CommandMonitor(MonitorSpec.model_validate(checks), LIMIT, NAMES)


def command(stamp: int, shoulder: float, elbow: float = 0.0, torque: float = 0.0) -> Command:
    """A command of two joints and one torque."""
    return Command(stamp, [0, 0, 0, torque, 0, 0], [shoulder, elbow])


def test_without_a_monitor_everything_passes_and_nothing_is_reported() -> None:
    """The command itself acts, whatever it is."""
    line, huge = CommandMonitor(None, LIMIT, NAMES), command(0, 1e9)
    assert line.check(huge) is huge
    assert line.check(None) is None
    assert line.events(5) == ()


def test_a_command_beyond_its_limit_is_refused_and_reported() -> None:
    """At the limit it passes as it is, beyond it does not act; the event names channel, value and what is accepted."""
    line, fine = monitor(limit={"factor": 1.5}), command(3, 15.0, -7.5, 3.0)
    assert line.check(fine) is fine
    assert line.events(4) == ()
    assert line.check(command(4, 1.0, -7.6)) is None
    (event,) = line.events(5)
    assert (event.stamp, event.level, event.name, event.message) == (5, WARN, REFUSED, "limit")
    expected = {"stamp": "4", "channel": "elbow", "commanded": "-7.6", "accepted": "-7.5 to 7.5", "count": "1"}
    assert dict(event.values) == expected
    assert line.events(6) == ()


def test_a_command_that_jumps_is_refused_or_clipped() -> None:
    """The change is bounded per period since the last command that was taken; the first one may be any."""
    line = monitor(rate={"factor": 0.1})
    assert line.check(command(0, 8.0)) is not None
    assert line.check(command(1, 6.9)) is None
    # Two periods later twice the change is accepted.
    assert line.check(command(2, 6.1)) is not None
    clipping = monitor(rate={"factor": 0.1, "response": "clip"})
    clipping.check(command(0, 8.0, 1.0))
    taken = clipping.check(command(1, -8.0, 1.2))
    assert taken is not None
    assert taken.stamp == 1
    np.testing.assert_allclose(taken.effort, [7.0, 1.2])
    (event,) = clipping.events(9)
    assert (event.name, event.message, dict(event.values)["channel"]) == (CLIPPED, "rate", "shoulder")


def test_the_channel_that_is_furthest_beyond_is_named() -> None:
    """By how much it is beyond, not by its size; of a change by the distance from the command before."""
    line = monitor(limit={"factor": 1.5})
    assert line.check(command(0, 16.0, 0.0, torque=5.0)) is None
    values = (
        ("stamp", "0"),
        ("channel", "torque_x"),
        ("commanded", "5.0"),
        ("accepted", "-3.0 to 3.0"),
        ("count", "1"),
    )
    assert line.events(1) == (DiagnosticEvent(1, WARN, REFUSED, "limit", "", values),)
    line = monitor(rate={"factor": 0.1})
    line.check(command(0, 8.0, -4.0))
    assert line.check(command(1, 6.0, 0.0)) is None
    values = (("stamp", "1"), ("channel", "elbow"), ("commanded", "0.0"), ("accepted", "-4.5 to -3.5"), ("count", "1"))
    assert line.events(2) == (DiagnosticEvent(2, WARN, REFUSED, "rate", "", values),)
    line.check(None)
    missing = DiagnosticEvent(3, WARN, MISSING, "no usable command", "", (("count", "1"),))
    assert line.events(3) == (missing,)


def test_a_clipped_command_is_as_much_as_passes() -> None:
    """Channels within their limit keep their numbers."""
    taken = monitor(limit={"factor": 1.0, "response": "clip"}).check(command(0, 12.0, -9.0, -1.0))
    assert taken is not None
    np.testing.assert_array_equal(taken.u, [0, 0, 0, -1.0, 0, 0, 10.0, -5.0])


def test_everything_is_counted_by_what_it_is() -> None:
    """Counts go on through a run and begin again with the next."""
    line = monitor(limit={"factor": 1.0})
    counts = []
    for stamp, given in enumerate((None, command(0, 11.0), None, command(0, 1.0), command(0, 99.0))):
        line.check(given)
        counts += [(event.name, dict(event.values)["count"]) for event in line.events(stamp)]
    assert counts == [(MISSING, "1"), (REFUSED, "1"), (MISSING, "2"), (REFUSED, "2")]
    line.reset()
    line.check(None)
    assert dict(line.events(1)[0].values)["count"] == "1"


def test_limits_are_those_of_the_actuators() -> None:
    """Joints and thrusters have theirs, wheels what they give together along an axis, a missing force none."""
    wheels = {"base_torque": {"kind": "reaction_wheels", "torque": 0.5, "momentum": 1.0,
                              "axes": ((1, 0, 0), (0, 1, 0), (0, 0, 1), (3, 0, 4))}}  # fmt: skip
    limit = command_limit(robot_of(arm_model(2), wheels | {"joints": {"effort": 7.0}}, floating=True))
    np.testing.assert_allclose(limit, [np.inf] * 3 + [0.8, 0.5, 0.9, 7.0, 7.0])


@pytest.mark.parametrize(
    "checks", [{"limit": {"factor": 0.0}}, {"rate": {}}, {"limit": {"factor": 1.0, "response": "x"}}]
)
def test_checks_that_cannot_be_are_refused(checks: dict[str, Any]) -> None:
    """A factor is positive, a response one of two."""
    with pytest.raises(ValueError, match=r"factor|response"):
        monitor(**checks)


def test_a_plant_that_hears_nothing_lets_go() -> None:
    """With ``last_for`` the last torque acts for N periods and not for ever, also where the monitor counts them."""
    q = np.array([0, 0, 0, 0, 0, 0, 1.0, *np.zeros(7)])
    plant = SimulatedRobot(
        robot_of(arm_model()),
        control_period=100_000_000,
        initial=InitialState(q, np.zeros(13)),
        hold=HoldFor(last_for=2),
        monitor=MonitorSpec(),
    )
    plant.reset()
    samples = [plant.step(Command(0, np.zeros(6), np.ones(7))), *(plant.step(None) for _ in range(4))]
    assert [sample.telemetry["applied_effort"][0] for sample in samples] == [1.0, 1.0, 1.0, 0.0, 0.0]
    assert [len(sample.events) for sample in samples] == [0, 1, 1, 1, 1]
