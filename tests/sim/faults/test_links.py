"""Links and nodes with faults: what arrives when, and what controller and plant do without it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_msgs_py.interfaces import Tick
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.plan import FaultPlan, plan_faults
from space_robot_sim.faults.wires import Wire
from tests.sim.faults.support import PERIOD, fault
from tests.support.robots import arm_model, robot_of

T = 250_000_000
WINDOW = {"at": 1.0, "for": 1.5}
BEGIN, END = 4, 10


@dataclass(frozen=True)
class Message:
    """A stamp."""

    stamp: int


def plan(*faults: Any, steps: int = 300) -> FaultPlan:
    """A plan for a robot of no importance."""
    return plan_faults(faults, FaultSite(robot_of(arm_model())), period=PERIOD, steps=steps, seed=3)


def arrived(*faults: Any, steps: int = 20) -> list[int | None]:
    """Stamps that are news at each tick, of messages that are sent at each tick."""
    wire: Wire[Message] = Wire(plan(*faults), "command")
    news = [wire.carry(tick, Message(tick)) for tick in range(steps)]
    return [None if one is None else one.stamp for one in news]


def simulated(*faults: dict[str, Any], **overrides: Any) -> list[Tick]:
    """The orientation task of `mini` for 5 s."""
    keys = {"duration": 5.0, "faults": list(faults)} | overrides
    sink = run_in_memory(compose(load_experiment("liu2023/fig08", keys)))
    assert sink.end_reason == "completed"
    return sink.ticks


@pytest.mark.parametrize(
    ("kind", "keys", "expected"),
    [
        ("link_drop", {}, [0, 1, 2, None, None, 5, 6, 7]),
        ("link_corrupt", {}, [0, 1, 2, None, None, 5, 6, 7]),
        ("link_delay", {"periods": 1}, [0, 1, 2, None, 3, 5, 6, 7]),
        ("link_delay", {"periods": 3}, [0, 1, 2, None, None, 5, 6, 7]),
        ("link_duplicate", {}, [0, 1, 2, 3, 4, 5, 6, 7]),
        ("link_reorder", {"probability": 1.0}, [0, 1, 2, None, 3, 5, 6, 7]),
    ],
)
def test_what_arrives_and_when(kind: str, keys: dict[str, Any], expected: list[int | None]) -> None:
    """In the window from tick 3 to 5; of several the newest is taken, and never one that is older than the last."""
    assert arrived(fault(kind, topic="command", at=0.3, **keys, **{"for": 0.2}), steps=8) == expected


def test_a_longer_delay_brings_everything_late() -> None:
    """Each message arrives, so many periods later, for as long as the window lasts."""
    assert arrived(fault("link_delay", topic="command", at=0.2, periods=3), steps=9) == [
        0,
        1,
        None,
        None,
        None,
        2,
        3,
        4,
        5,
    ]


@pytest.mark.parametrize("kind", ["link_drop", "link_corrupt", "link_reorder"])
def test_a_probability_is_that_of_each_message(kind: str) -> None:
    """About so many are lost, and the same ones each time."""
    half = fault(kind, topic="command", at=0.0, probability=0.3)
    found = arrived(half, steps=300)
    assert found == arrived(half, steps=300)
    assert 0.2 < np.mean([one is None for one in found]) < 0.4


def test_a_message_that_was_not_sent_does_not_arrive() -> None:
    """Where nothing is sent only what is under way arrives."""
    wire: Wire[Message] = Wire(plan(fault("link_delay", topic="command", at=0.0, periods=2)), "command")
    assert [wire.carry(0, Message(0)), wire.carry(1, None)] == [None, None]
    assert wire.carry(2, None) == Message(0)
    assert wire.carry(3, None) is None


def test_a_lost_command_leaves_the_plant_in_its_hold() -> None:
    """Within the window the command of before acts (or nothing), and the log has what was sent."""
    for hold, held in (("last", (BEGIN - 1) * T), ("zero", -1)):
        ticks = simulated({"kind": "link_drop", "topic": "command", **WINDOW}, **{"plant.hold": hold})
        acted = [int(tick.sample.telemetry["command_stamp"][0]) for tick in ticks]
        assert set(acted[BEGIN + 1 : END + 1]) == {held}
        assert acted[END + 1 :] == [tick.stamp - T for tick in ticks[END + 1 :]]
        assert [tick.output.command.stamp for tick in ticks] == [k * T for k in range(21)]


def test_a_late_command_acts_late() -> None:
    """With two periods of delay the command of two ticks before acts."""
    ticks = simulated({"kind": "link_delay", "topic": "command", "periods": 2, "at": 1.0})
    acted = [int(tick.sample.telemetry["command_stamp"][0]) for tick in ticks]
    assert acted[BEGIN + 3 :] == [tick.stamp - 3 * T for tick in ticks[BEGIN + 3 :]]


def test_a_state_that_does_not_arrive_is_the_last_one() -> None:
    """The law answers the state of before again, under the stamp of the tick; the log has what was measured."""
    pd = {"controller.law": "pd", "reference": {"kind": "hold"}, "initial.angular_velocity": [0.01, 0.02, 0.0]}
    ticks = simulated({"kind": "link_drop", "topic": "state", **WINDOW}, **pd)
    efforts = [tick.output.command.u.tobytes() for tick in ticks]
    assert len(set(efforts[BEGIN - 1 : END])) == 1
    assert efforts[END] != efforts[END - 1]
    assert len({tick.sample.state.q.tobytes() for tick in ticks}) == len(ticks)


def test_without_guidance_the_controller_keeps_its_reference() -> None:
    """Silent guidance and a dropped reference are the same to the controller."""
    moving = {"reference": {"kind": "harmonic", "yaw": {"amplitude_deg": 10, "frequency": 0.1}}}
    silent = simulated({"kind": "guidance_silent", **WINDOW}, **moving)
    dropped = simulated({"kind": "link_drop", "topic": "reference", **WINDOW}, **moving)
    well = simulated(**moving)
    commands = [[tick.output.command.u.tobytes() for tick in ticks] for ticks in (silent, dropped, well)]
    assert commands[0] == commands[1]
    assert commands[0][:BEGIN] == commands[2][:BEGIN]
    assert commands[0][BEGIN] != commands[2][BEGIN]


def test_a_silent_controller_is_reset_when_it_is_back() -> None:
    """The plant holds meanwhile; the first command that acts again comes from a law without a past."""
    ticks = simulated({"kind": "controller_silent", **WINDOW}, **{"plant.hold": "zero"})
    acted = [int(tick.sample.telemetry["command_stamp"][0]) for tick in ticks]
    assert set(acted[BEGIN + 1 : END + 1]) == {-1}
    assert acted[END + 1] == END * T
    assert [(tick.stamp, event.kind) for tick in ticks for event in tick.output.events] == [(END * T, "reset")]


def test_a_restarted_controller_forgets() -> None:
    """From its onset on the law answers as one that never answered before."""
    keys = {"controller.law": "adaptive", "controller.gains": {"update": "rls"}, "plant.payload": {"mass": 1.0}}
    ticks = simulated({"kind": "controller_restarted", "at": 2.0}, **keys)
    assert [(tick.stamp, event.kind) for tick in ticks for event in tick.output.events] == [(8 * T, "reset")]
    fresh = compose(load_experiment("liu2023/fig08", {"duration": 5.0} | keys)).controller()
    fresh.reset()
    expected = fresh.update(ticks[8].sample.state, ticks[8].reference).command
    assert ticks[8].output.command.u.tobytes() == expected.u.tobytes()


def test_a_duplicate_changes_nothing() -> None:
    """With every message twice on all links the run is, to the bit, the one without."""
    twice = [{"kind": "link_duplicate", "topic": topic, "at": 0.0} for topic in ("command", "state", "reference")]
    for one, other in zip(simulated(*twice), simulated(), strict=True):
        assert one.sample.state.q.tobytes() == other.sample.state.q.tobytes()
        assert one.output.command.u.tobytes() == other.output.command.u.tobytes()


def test_dropouts_and_nan_repeat_the_last_reading() -> None:
    """No number that is none gets anywhere: the reading of before is there again."""
    for kind in ("sensor_dropout", "sensor_nan"):
        ticks = simulated({"kind": kind, "channel": "angular_velocity", "probability": 0.5, **WINDOW})
        rates = [tick.sample.state.v[3:6].tobytes() for tick in ticks]
        repeated = [k for k in range(1, len(rates)) if rates[k] == rates[k - 1]]
        assert repeated
        assert set(repeated) <= set(range(BEGIN, END))
        assert len(repeated) < END - BEGIN
