"""What counts as equal, and what never does."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_bringup.replay.comparison import EXACT, Comparison, Tolerance
from space_robot_bringup.replay.recording import changed, flat
from space_robot_msgs_py.codec.codecs import CommandCodec, TelemetryCodec
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import CONTROLLER_TELEMETRY, JOINT_COMMAND, WRENCH_COMMAND
from tests.support import values

NAMES = ("a", "b")
CODEC = CommandCodec(NAMES)


def compared(recorded: tuple[bytes, ...], fresh: tuple[bytes, ...], tolerance: Tolerance = EXACT) -> Comparison:
    comparison = Comparison(NAMES, tolerance)
    topics = CODEC.topics
    was = {topic.name: raw for topic, raw in zip(topics, recorded, strict=True)}
    comparison.compare(0, was, zip(topics, fresh, strict=True))
    return comparison


def command(*effort: float) -> tuple[bytes, ...]:
    return CODEC.encode(Command(0, np.zeros(6), np.array(effort)))


@given(st.lists(values.numbers, min_size=2, max_size=2), st.integers(0, 1), st.integers(0, 63))
def test_one_bit_is_a_difference(effort, index, bit):
    """Without tolerances any other bit is found, at its joint, signed zeros and subnormals among them."""
    bits = np.array(effort).view(np.uint64)
    bits[index] ^= np.uint64(1 << bit)
    other = bits.view(np.float64)
    if not np.isfinite(other).all():
        return
    found = compared(command(*effort), command(*other)).first
    assert found is not None
    assert (found.topic, found.field) == (JOINT_COMMAND.name, f"effort[{NAMES[index]}]")
    assert compared(command(*effort), command(*effort)).first is None


@pytest.mark.parametrize("wild", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("tolerance", [EXACT, Tolerance(rtol=1e6, atol=1e300), Tolerance(atol=1e300)])
def test_a_non_finite_value_is_never_equal_to_a_number(wild, tolerance):
    """No tolerance makes a recorded NaN or infinity equal to a number."""
    poisoned = (command(0.0, 0.0)[0], command(0.0, 0.0)[1][:-8] + np.array([wild]).tobytes())
    assert compared(poisoned, command(0.0, 0.0), tolerance).first is not None


@given(st.floats(1e-6, 1e6), st.floats(1e-12, 0.5))
def test_the_relative_tolerance_is_of_the_largest_number_of_the_block(scale, share):
    """A small number may be off by as much as a large one beside it, and no more."""
    for factor, equal in ((0.5, True), (2.0, False)):
        other = command(scale, factor * share * scale)
        assert (compared(command(scale, 0.0), other, Tolerance(rtol=share)).first is None) is equal


def test_blocks_that_come_go_or_change_places_are_differences():
    """Another label, another size and another order of telemetry are not equal; ignored ones are not looked at."""
    codec = TelemetryCodec(CONTROLLER_TELEMETRY)

    def telemetry(**blocks):
        return {CONTROLLER_TELEMETRY.name: codec.encode(Telemetry.of(0, blocks))[0]}

    was = telemetry(error=[1.0, 2.0], gain=3.0)
    cases = {
        "gain": telemetry(error=[1.0, 2.0]),
        "surprise": telemetry(error=[1.0, 2.0], gain=3.0, surprise=0.0),
        "error": telemetry(error=[1.0], gain=3.0),
        "order of blocks": telemetry(gain=3.0, error=[1.0, 2.0]),
    }
    for field, now in cases.items():
        comparison = Comparison(NAMES, EXACT)
        comparison.compare(0, was, [(CONTROLLER_TELEMETRY, now[CONTROLLER_TELEMETRY.name])])
        assert comparison.first is not None
        assert comparison.first.field == field
    ignoring = Comparison(NAMES, Tolerance(ignore=(f"{CONTROLLER_TELEMETRY.name}/gain",)))
    ignoring.compare(0, was, [(CONTROLLER_TELEMETRY, cases["gain"][CONTROLLER_TELEMETRY.name])])
    assert ignoring.first is None


def test_the_worst_and_the_first_are_kept():
    """First by the order of the log, worst by distance, and how many messages are off."""
    comparison = Comparison(NAMES, EXACT)
    for stamp, off in ((0, 0.0), (1, 0.1), (2, 0.5), (3, 0.2)):
        raw = {JOINT_COMMAND.name: command(1.0, 1.0)[1]}
        comparison.compare(stamp, raw, [(JOINT_COMMAND, command(1.0, 1.0 + off)[1])])
    assert comparison.first is not None
    assert comparison.first.stamp == 1
    assert comparison.worst[JOINT_COMMAND.name, "effort"].stamp == 2
    assert comparison.differing[JOINT_COMMAND.name, "effort"] == 3
    assert comparison.compared == {JOINT_COMMAND.name: 4}


def test_a_message_that_does_not_fit_is_a_difference():
    """A recorded command with other names is named as such, not passed over."""
    other = CommandCodec(("x", "y")).encode(Command(0, np.zeros(6), np.zeros(2)))
    found = compared((command(0.0, 0.0)[0], other[1]), command(0.0, 0.0)).first
    assert found is not None
    assert (found.topic, found.field) == (JOINT_COMMAND.name, "layout")
    assert WRENCH_COMMAND.name not in str(found.recorded)


def test_changes_are_named_by_their_keys():
    """Dotted key to recorded and new value, lists as values, nothing else."""
    data = {"robot": "mini", "control_period": 0.1, "duration": 1.0, "reference": {"kind": "hold"}}
    overrides = ["seed=3", "initial.position=[1, 0, 0]"]
    assert changed(data, overrides, "test") == {
        "seed": (0, 3),
        "initial.position": ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    }
    assert changed(data, [], "test") == {}
    rows = {"m": [{"name": "a", "above": 1}, {"name": "b", "above": 2}], "f": [{"kind": "x"}, {"kind": "x"}]}
    assert flat(rows) == {"m.a.name": "a", "m.a.above": 1, "m.b.name": "b", "m.b.above": 2} | {
        "f.0.kind": "x",
        "f.1.kind": "x",
    }
    assert flat(json.loads('{"a": {"b": 1, "c": {}}, "d": [1]}')) == {"a.b": 1, "a.c": {}, "d": [1]}
