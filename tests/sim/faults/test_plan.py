"""Windows and events of faults, and what is refused before anything runs."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_msgs_py.codec.codecs import decode_statuses, encode_statuses
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import ERROR, OK
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.catalogue import KINDS, groups, keys_of, meaning, parse_fault
from space_robot_sim.faults.plan import FaultPlan, plan_faults
from space_robot_sim.spec import SensorSpec
from tests.sim.faults.support import PERIOD, STEPS, WHEELS, fault, simulated
from tests.support.robots import arm_model, robot_of

SITE = FaultSite(robot_of(arm_model(), WHEELS, floating=True), SensorSpec(), 0.1)
PUSHED = FaultSite(robot_of(arm_model()), SensorSpec(), 0.1)


def planned(*faults: Any, site: FaultSite = SITE) -> FaultPlan:
    """A plan for 4 s."""
    return plan_faults(faults, site, period=PERIOD, steps=STEPS, seed=1)


@pytest.mark.parametrize(
    ("keys", "first", "end"),
    [
        ({"at": 1.0, "for": 1.5}, 10, 25),
        ({"at": 1.0000001, "for": 0.1}, 11, 12),
        ({"at": 0.0}, 0, STEPS + 1),
        ({"at": 0.1 + 0.2, "for": 0.1}, 3, 4),
        ({"at": 3.9, "for": 0.1}, 39, 40),
    ],
)
def test_a_window_is_that_of_the_ticks_in_it(keys: dict[str, float], first: int, end: int) -> None:
    """It begins with the first tick at or after its onset, and ends before the first one at or after its end."""
    (one,) = planned(fault("joint_stuck", joint="joint_1", **keys)).planned
    assert (one.first, one.end) == (first, end)
    assert [tick for tick in range(STEPS + 1) if one.acts(tick)] == list(range(first, min(end, STEPS + 1)))


def test_onset_and_end_are_events_of_the_truth() -> None:
    """Each fault has an event at its first tick and one behind its last, with its keys; the plant shows them."""
    faults = [
        fault("joint_effectiveness", joint="joint_1", factor=0.5, **{"for": 1.0}),
        fault("joint_stuck", joint="joint_2", name="brake", at=2.0),
    ]
    samples = simulated(faults)
    commanded = {tick: sample.faults for tick, sample in enumerate(samples) if sample.faults}
    assert list(commanded) == [10, 20]
    (begins,) = commanded[10]
    assert (begins.stamp, begins.level, begins.name) == (10 * PERIOD, ERROR, "joint_effectiveness joint_1")
    assert (begins.message, begins.hardware) == ("begins", "joint_1")
    assert dict(begins.values) == {"kind": "joint_effectiveness", "joint": "joint_1", "factor": "0.5"}
    assert [(one.level, one.name, one.message) for one in commanded[20]] == [
        (OK, "joint_effectiveness joint_1", "ends"),
        (ERROR, "brake", "begins"),
    ]
    assert decode_statuses(encode_statuses(commanded[20])) == commanded[20]


def test_every_fault_of_a_run_has_a_name_of_its_own() -> None:
    """Equal kinds on one place are numbered."""
    twice = [fault("joint_stuck", joint="joint_1", at=at, **{"for": 0.5}) for at in (0.5, 1.5)]
    other = fault("joint_stuck", joint="joint_2")
    labels = [one.label for one in planned(*twice, other).planned]
    assert labels == ["joint_stuck joint_1 #1", "joint_stuck joint_1 #2", "joint_stuck joint_2"]


@pytest.mark.parametrize(
    ("kind", "keys", "key", "accepted"),
    [
        ("joint_stuck", {"joint": "joint_9"}, "faults.0.joint", "joint_"),
        ("joint_stuck", {"joint": "joint_1", "at": 4.0}, "faults.0.at", "3.9 s"),
        ("joint_stuck", {"joint": "joint_1", "for": 3.5}, "faults.0.for", "up to 3 s"),
        ("joint_stuck", {"joint": "joint_1", "at": 1.01, "for": 0.05}, "faults.0.for", "0.1 s"),
        ("wheel_stopped", {"wheel": 3}, "faults.0.wheel", "0 to 2"),
        ("thruster_weak", {"axis": "force_x", "factor": 0.5}, "faults.0.axis", "thrusters"),
        ("payload_lost", {}, "faults.0", "plant.payload"),
        ("payload_shifted", {"offset": (0.1, 0.0, 0.0)}, "faults.0", "plant.payload"),
        ("payload_captured", {"payload": {"mass": -1.0}}, "faults.0.payload", ""),
        ("payload_captured", {"payload": {"mass": 1.0, "frame": "nowhere"}}, "faults.0.payload", ""),
        ("inertia_change", {"body": "joint_1", "factor": 2.0}, "faults.0.body", "joint_1_body"),
        ("wrench_pulse", {}, "faults.0.force", "not zero"),
        ("sensor_noise", {"channel": "position", "factor": 3.0}, "faults.0.factor", "sigma"),
        ("sensor_delay", {"channel": "position", "delay": 0.25}, "faults.0.delay", "0.1 s"),
        ("sensor_frame", {"channel": "joint_position", "rpy_deg": (0.0, 0.0, 90.0)}, "faults.0.channel", "attitude"),
        ("sensor_bias", {"channel": "joint_position", "bias": (1.0, 2.0)}, "faults.0.bias", "7"),
        ("controller_restarted", {"for": 1.0}, "faults.0.for", "controller_silent"),
    ],
)  # fmt: skip
def test_what_the_robot_or_the_run_does_not_have_is_refused(
    kind: str, keys: dict[str, Any], key: str, accepted: str
) -> None:
    """The error names the key, the value and what is accepted, in one line."""
    with pytest.raises(SpecError) as caught:
        planned(fault(kind, **keys))
    assert caught.value.key == key
    assert accepted in str(caught.value)
    assert "\n" not in str(caught.value)


def test_wheels_and_thrusters_are_those_of_the_robot() -> None:
    """A robot without wheels has no wheel to stop."""
    with pytest.raises(SpecError, match=r"faults\.0\.wheel: no such wheel.*reaction wheels"):
        planned(fault("wheel_stopped", wheel=0), site=PUSHED)
    planned(fault("thruster_weak", axis="torque_z", factor=0.5), site=PUSHED)


def test_a_fault_is_typed_as_kind_and_keys() -> None:
    """Values are YAML, lists and sections too; spaces inside of brackets and quotes are part of them."""
    assert parse_fault("joint_stuck joint=joint2 at=20") == {"kind": "joint_stuck", "joint": "joint2", "at": 20}
    text = "wrench_pulse  force=[0, 1.5, 0] at=1 for=0.5 name='a push'"
    assert parse_fault(text) == {"kind": "wrench_pulse", "force": [0, 1.5, 0], "at": 1, "for": 0.5, "name": "a push"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no such kind of fault"),
        ("joint_stck joint=joint2 at=20", "joint_stuck"),
        ("joint_stuck joint=joint2", "at: is required"),
        ("joint_stuck joint=joint2 at=20 at=30", "one too many"),
        ("joint_stuck joint=joint2 at=20 kind=joint_free", "one too many"),
        ("joint_stuck joint2 at=20", "not an assignment"),
        ("joint_stuck joint=joint2 at=20 factr=1", "factr: unknown key"),
        ("joint_stuck joint=joint2 at=.nan", "at"),
        ("joint_stuck joint=joint2 at=-1", "at"),
        ("joint_stuck joint=joint2 at=1 for=0", "for"),
        ("wrench_pulse at=1 force=[0, 1", "left open"),
    ],
)
def test_a_typed_fault_that_is_none_is_one_line(text: str, said: str) -> None:
    """The error names the option as it was typed."""
    with pytest.raises(SpecError) as caught:
        parse_fault(text)
    assert str(caught.value).startswith("--fault ")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_catalogue_explains_every_kind() -> None:
    """Each kind is in one group, says what happens, and explains each key of its own with a unit where it has one."""
    assert [kind for kinds in groups().values() for kind in kinds] == list(KINDS)
    assert list(groups()) == ["joints", "wheels", "thrusters", "body", "sensors", "links", "nodes"]
    for kind in KINDS:
        assert meaning(kind).endswith(".")
        assert all(key.meaning for key in keys_of(kind))
        assert KINDS[kind].model_json_schema()["properties"]["for"]
