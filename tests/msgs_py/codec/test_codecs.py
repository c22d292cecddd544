from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import (
    LOGGED,
    CommandCodec,
    ReferenceCodec,
    StateCodec,
    TelemetryCodec,
    TickCodec,
    decode_clock,
    decode_statuses,
    decode_string,
    encode_clock,
    encode_statuses,
    encode_string,
    encode_tick_statuses,
    peek_stamp,
    says_none,
)
from space_robot_msgs_py.codec.generic import canonical_message, parse
from space_robot_msgs_py.errors import CommandError, LayoutError, NonFiniteError
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import CONTROLLER_TELEMETRY, JOINT_COMMAND
from tests.support import values

KINDS = [(StateCodec, values.states), (ReferenceCodec, values.references), (CommandCodec, values.commands)]
NAN = np.array([np.nan]).tobytes()
each_kind = pytest.mark.parametrize(("codec_class", "strategy"), KINDS, ids=["state", "reference", "command"])
quick = settings(deadline=None, max_examples=40)


@each_kind
@quick
@given(data=st.data())
def test_round_trip(codec_class, strategy, data):
    """Value to bytes to value gives the same bits, whatever the joints are called and how many there are."""
    names = data.draw(values.joint_names())
    value = data.draw(strategy(len(names)))
    codec = codec_class(names)
    parts = codec.encode(value)
    assert len(parts) == len(codec.topics)
    assert values.bits(codec.decode(parts)) == values.bits(value)
    assert {peek_stamp(part) for part in parts} == {value.stamp}


@each_kind
@quick
@given(data=st.data())
def test_bytes_are_those_of_an_independent_serialiser(codec_class, strategy, data):
    """Rosbags reads our bytes and serialises the message to the same bytes."""
    names = data.draw(values.joint_names())
    codec = codec_class(names)
    for topic, raw in zip(codec.topics, codec.encode(data.draw(strategy(len(names)))), strict=True):
        assert canonical_message(topic.type, raw) == raw


@quick
@given(telemetry=values.telemetries())
def test_telemetry_round_trip(telemetry):
    """Telemetry comes back with its labels and bits, through a codec that never saw them, and as rosbags writes it."""
    raw = TelemetryCodec(CONTROLLER_TELEMETRY).encode(telemetry)[0]
    assert values.bits(TelemetryCodec(CONTROLLER_TELEMETRY).decode([raw])) == values.bits(telemetry)
    assert canonical_message(CONTROLLER_TELEMETRY.type, raw) == raw


@quick
@given(first=values.telemetries(), second=values.telemetries())
def test_telemetry_may_change_its_labels(first, second):
    """One codec reads messages of different shapes in any order."""
    codec = TelemetryCodec(CONTROLLER_TELEMETRY)
    raws = [codec.encode(one)[0] for one in (first, second, first)]
    assert [values.bits(codec.decode([raw])) for raw in raws] == [values.bits(one) for one in (first, second, first)]


def test_fields_are_where_tools_expect_them():
    """Pose, twist, efforts and rates stand in the fields of the standard messages that mean them."""
    tick = values.run_ticks(1)[0]
    codec = TickCodec(values.NAMES)
    messages = {topic.name: parse(topic.type, raw) for topic, raw in zip(LOGGED, codec.encode(tick), strict=True)}
    state, reference = tick.sample.state, tick.reference
    odometry, joints, imu = messages["base/odom"], messages["joint_states"], messages["base/imu"]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("inertial", "base_link")
    position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
    assert [position.x, position.y, position.z, orientation.x, orientation.w] == [*state.q[:4], state.q[6]]
    assert [odometry.twist.twist.linear.x, odometry.twist.twist.angular.z] == [state.v[0], state.v[5]]
    assert tuple(joints.name) == values.NAMES
    assert joints.position.tolist() == state.joints.tolist()
    assert joints.velocity.tolist() == state.joint_rates.tolist()
    assert joints.effort.tolist() == state.effort.tolist()
    assert [imu.orientation.x, imu.angular_velocity.y] == [state.q[3], state.v[4]]
    assert imu.linear_acceleration.z == state.base_acceleration[2]
    wheels = messages["base/wheel_momentum"]
    assert wheels.header.frame_id == "base_link"
    assert [wheels.vector.x, wheels.vector.y, wheels.vector.z] == state.wheel_momentum.tolist()
    assert messages["reference/base"].child_frame_id == "base_link_desired"
    assert messages["reference/base_accel"].accel.angular.z == reference.a[5]
    (point,) = messages["reference/joints"].points
    assert (point.positions.tolist(), point.effort.size) == (reference.q[7:].tolist(), 0)
    assert messages["base/wrench_command"].wrench.torque.x == tick.output.command.wrench[3]
    command = messages["joint_command"]
    assert (command.position.size, command.velocity.size) == (0, 0)
    assert command.effort.tolist() == tick.output.command.effort.tolist()
    telemetry = messages["controller/telemetry"]
    assert [(dim.label, dim.size, dim.stride) for dim in telemetry.layout.dim] == [
        ("stamp", 1, 1), ("error", 3, 3), ("gain", 1, 1)
    ]  # fmt: skip


def test_wrong_joint_names_are_refused():
    """A joint command without one of the joints is a CommandError with what there is and what is missing."""
    parts = CommandCodec(("a", "other", "c")).encode(Command(0, np.zeros(6), np.zeros(3)))
    with pytest.raises(CommandError, match=r"joint_command\.name: .*missing; got 'a, other, c'; .*missing: b"):
        CommandCodec(("a", "b", "c")).decode(parts)


def test_wrong_number_of_joints_is_refused():
    """A joint command of fewer joints is a CommandError that names those that are missing."""
    parts = CommandCodec(("a", "b")).encode(Command(0, np.zeros(6), np.zeros(2)))
    with pytest.raises(CommandError, match=r"joint_command\.name.*got 'a, b'; .*missing: c"):
        CommandCodec(("a", "b", "c")).decode(parts)


def test_missing_efforts_are_refused():
    """Right names without efforts are a CommandError at the effort."""
    raw = CommandCodec(("a",)).encode(Command(0, np.zeros(6), np.zeros(1)))[1]
    message = parse(JOINT_COMMAND.type, raw)
    message.effort = np.zeros(0)
    from space_robot_msgs_py.codec.schemas import typestore

    short = bytes(typestore().serialize_cdr(message, JOINT_COMMAND.type))
    with pytest.raises(CommandError, match=r"joint_command\.effort.*got 0.*accepted: 1"):
        CommandCodec(("a",)).decode_part(1, short)


@pytest.mark.parametrize("size", range(0, 76, 5))
def test_truncated_messages_are_refused(size):
    """A message that ends early is a CommandError, wherever it ends."""
    codec = CommandCodec(("a",))
    wrench, joints = codec.encode(Command(0, np.ones(6), np.ones(1)))
    with pytest.raises(CommandError, match=r"base/wrench_command"):
        codec.decode((wrench[:size], joints))


@each_kind
def test_nan_is_refused(codec_class, strategy):
    """NaN in any number that becomes part of a value is a NonFiniteError."""
    tick = values.run_ticks(1)[0]
    value = {"states": tick.sample.state, "references": tick.reference, "commands": tick.output.command}
    codec = codec_class(values.NAMES)
    parts = list(codec.encode(value[strategy.__name__]))
    # base/imu repeats attitude and rates; those copies are not part of the value.
    copies = 2 if codec_class is StateCodec else 0
    for index, layout in enumerate(codec.layouts):
        for start, stop in layout.holes[1 + (copies if index == 2 else 0) :]:
            for at in range(start, stop, 8):
                bad = parts[index][:at] + NAN + parts[index][at + 8 :]
                with pytest.raises(NonFiniteError):
                    codec.decode([*parts[:index], bad, *parts[index + 1 :]])


def test_parts_of_different_stamps_are_refused():
    """A value is never put together from messages of two stamps."""
    codec = CommandCodec(values.NAMES)
    first, second = (codec.encode(Command(stamp, np.zeros(6), np.zeros(3))) for stamp in (1, 2))
    with pytest.raises(LayoutError, match=r"\[1, 2\]"):
        codec.decode((first[0], second[1]))


def test_ticks_of_different_stamps_are_refused():
    """A tick is never put together from values of two stamps, neither writing nor reading."""
    codec, (first, second) = TickCodec(values.NAMES), values.run_ticks(2)
    rows = [dict(zip([topic.name for topic in LOGGED], codec.encode(tick), strict=True)) for tick in (first, second)]
    for name in ("joint_states", "base/wrench_command", "plant/telemetry"):
        with pytest.raises(LayoutError, match="stamps"):
            codec.decode(rows[0] | {name: rows[1][name]})
    with pytest.raises(LayoutError, match="stamps"):
        codec.encode(type(first)(first.sample, second.reference, first.output))


def test_decode_part_and_join_are_decode():
    """Decoding parts one by one gives the value that decoding them together gives."""
    state = replace(values.run_ticks(1)[0].sample.state, wheel_momentum=None)
    codec = StateCodec(values.NAMES)
    decoded = [codec.decode_part(index, raw) for index, raw in enumerate(codec.encode(state))]
    assert {stamp for stamp, _ in decoded} == {state.stamp}
    assert values.bits(codec.join(state.stamp, [blocks for _, blocks in decoded])) == values.bits(state)


def test_a_part_that_is_heard_is_read_like_any_other():
    """The short way of canonical bytes gives what the long way of other bytes gives, which refuses what is too long."""
    state = replace(values.run_ticks(3)[2].sample.state, wheel_momentum=None)
    codec = StateCodec(values.NAMES)
    for index, raw in enumerate(codec.encode(state)):
        found = codec.hear_part(index, raw)
        assert found == codec.decode_part(index, raw) == codec.hear_part(index, raw + b"\0\0\0\0")
        assert {type(one) for one in (found[1], codec.hear_part(index, raw + bytes(4))[1])} == {tuple}
        with pytest.raises(LayoutError):
            codec.hear_part(index, raw + bytes(10**6))


@pytest.mark.parametrize("stamp", [-1, 2**53, 2**60])
def test_telemetry_stamp_must_be_exact(stamp):
    """A stamp float64 cannot hold exactly is refused."""
    with pytest.raises(LayoutError, match="2\\^53"):
        TelemetryCodec(CONTROLLER_TELEMETRY).encode(Telemetry.of(stamp, {"a": 1.0}))


@pytest.mark.parametrize("value", [0.5, -1.0, np.nan, np.inf, 2.0**53])
def test_telemetry_with_a_foreign_stamp_is_refused(value):
    """Only whole nanoseconds are a stamp."""
    raw = TelemetryCodec(CONTROLLER_TELEMETRY).encode(Telemetry.of(3, {}))[0]
    with pytest.raises(LayoutError, match="stamp"):
        TelemetryCodec(CONTROLLER_TELEMETRY).decode([raw[:-8] + np.float64(value).tobytes()])


@pytest.mark.parametrize("labels", [("stamp",), ("a", "a")])
def test_ambiguous_labels_are_refused(labels):
    """Every label names one block."""
    with pytest.raises(LayoutError, match="ambiguous"):
        TelemetryCodec(CONTROLLER_TELEMETRY).encode(Telemetry(0, labels, (1,) * len(labels), np.zeros(len(labels))))


@quick
@given(raw=st.binary(max_size=120))
def test_noise_is_refused_as_telemetry(raw):
    """Arbitrary bytes behind a CDR header are a LayoutError and nothing else."""
    with pytest.raises(LayoutError):
        TelemetryCodec(CONTROLLER_TELEMETRY).decode([b"\x00\x01\x00\x00" + raw])


@quick
@given(text=st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",))))
def test_string_round_trip(text):
    """A text comes back, also with what DDS appends, and its bytes are rosbags'."""
    raw = encode_string(text)
    assert decode_string(raw) == decode_string(raw + bytes(3)) == text
    assert canonical_message("std_msgs/msg/String", raw) == raw


@pytest.mark.parametrize(
    "raw", [b"", b"\0\1\0\0", b"\0\1\0\0\x05\0\0\0abc", b"\0\1\0\0\x02\0\0\0\xff\0", b"\0\1\0\0\1\0\0\0a"]
)
def test_broken_strings_are_refused(raw):
    """A text that is cut, not terminated or not UTF-8 is a LayoutError."""
    with pytest.raises(LayoutError):
        decode_string(raw)


@quick
@given(stamp=st.integers(0, 2**31 * 10**9 - 1))
def test_clock_round_trip(stamp):
    """A time comes back, and its bytes are rosbags'."""
    raw = encode_clock(stamp)
    assert decode_clock(raw) == stamp
    assert canonical_message("rosgraph_msgs/msg/Clock", raw) == raw


@pytest.mark.parametrize("stamp", [-1, 2**31 * 10**9])
def test_stamps_out_of_range_are_refused(stamp):
    """A stamp that builtin_interfaces/Time cannot hold is a LayoutError."""
    with pytest.raises(LayoutError, match="stamp"):
        encode_clock(stamp)


@pytest.mark.parametrize(
    "raw", [b"", b"\0\1\0\0abc", b"\0\1\0\0\xff\xff\xff\xff\0\0\0\0", b"\0\1\0\0\0\0\0\0\0\xca\x9a\x3b"]
)
def test_peek_stamp_refuses_what_is_no_stamp(raw):
    """Too few bytes, negative seconds or a whole second of nanoseconds are a LayoutError."""
    with pytest.raises(LayoutError):
        peek_stamp(raw)


def test_values_of_another_size_are_not_encoded():
    """A command for more joints than the codec has is refused, not cut."""
    with pytest.raises(CommandError, match=r"joint_command\.effort"):
        CommandCodec(("a",)).encode(Command(0, np.zeros(6), np.zeros(2)))


@pytest.mark.parametrize("stamp", [0, 250_000_000, 2**31 * 10**9 - 1])
def test_a_tick_without_events_says_so_in_a_message_of_its_own(stamp: int) -> None:
    """Such a message has its stamp, is distinguished from one with an event, and is refused where events are read."""
    none = encode_tick_statuses(stamp, ())
    some = encode_statuses([DiagnosticEvent(stamp, 0, "", "", "", ())])
    assert (says_none(none), says_none(some), says_none(none[:-1])) == (True, False, False)
    assert peek_stamp(none) == stamp
    with pytest.raises(LayoutError, match="no event in it"):
        decode_statuses(none)
