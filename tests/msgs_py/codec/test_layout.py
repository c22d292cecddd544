import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import LOGGED, CommandCodec, StateCodec, TelemetryCodec, TickCodec, TopicBytes
from space_robot_msgs_py.codec.generic import canonical_message, parse
from space_robot_msgs_py.codec.layout import LayoutBuilder
from space_robot_msgs_py.codec.schemas import typestore
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.topics import BASE_ODOM, CONTROLLER_TELEMETRY, JOINT_STATES, WRENCH_COMMAND
from tests.support import values

quick = settings(deadline=None, max_examples=60)
CODEC = TickCodec(values.NAMES)
TICK = values.run_ticks(1)[0]
PARTS = dict(zip(LOGGED, CODEC.encode(TICK), strict=True))
LAYOUTS = {
    topic: layout
    for codec in (CODEC.state, CODEC.reference, CODEC.command)
    for topic, layout in zip(codec.topics, codec.layouts, strict=True)
} | {topic: CODEC.controller_telemetry.layout_of(PARTS[topic]) for topic in (CONTROLLER_TELEMETRY,)}


def padding(layout):
    """Positions of the bytes that no field owns, the encapsulation options among them."""
    used = {0, 1}.union(*(range(field.start, field.stop) for field in layout.fields))
    return [at for at in range(layout.size) if at not in used]


def with_garbage(raw, places, fill, trailing):
    """The message with these bytes in its padding and behind it."""
    soiled = bytearray(raw)
    for at, byte in zip(places, fill, strict=False):
        soiled[at] = byte
    return bytes(soiled) + trailing


@pytest.mark.parametrize("topic", LAYOUTS, ids=lambda topic: topic.name)
@quick
@given(fill=st.binary(min_size=64, max_size=64), trailing=st.binary(max_size=15))
def test_padding_is_ignored_and_cleaned(topic, fill, trailing):
    """Garbage in padding and behind a message changes nothing that is decoded and vanishes from the canonical form."""
    layout, raw = LAYOUTS[topic], PARTS[topic]
    soiled = with_garbage(raw, padding(layout), fill, trailing)
    assert layout.matches(soiled)
    assert layout.blocks(soiled) == layout.blocks(raw)
    assert layout.canonical(soiled) == raw
    assert TopicBytes(values.NAMES).read(topic, soiled) == (TICK.stamp, raw)


@pytest.mark.parametrize("topic", LAYOUTS, ids=lambda topic: topic.name)
def test_changing_any_byte_is_refused_or_changes_the_value(topic):
    """Changing any byte of a constant is refused; changing one of a number changes what is decoded."""
    layout, raw = LAYOUTS[topic], PARTS[topic]
    free = {at for field in layout.fields if field.kind == "ignored" for at in range(field.start, field.stop)}
    holes = {at for start, stop in layout.holes for at in range(start, stop)}
    for at in sorted(set(range(layout.size)) - set(padding(layout)) - free):
        changed = raw[:at] + bytes([raw[at] ^ 1]) + raw[at + 1 :]
        if at in holes:
            assert layout.blocks(changed) != layout.blocks(raw)
        else:
            assert not layout.matches(changed)
            with pytest.raises((LayoutError, CommandError), match=topic.name):
                layout.blocks(changed)


@pytest.mark.parametrize("topic", LAYOUTS, ids=lambda topic: topic.name)
def test_wrong_lengths_are_refused(topic):
    """A message that is cut, or has more behind it than alignment explains, is refused."""
    layout, raw = LAYOUTS[topic], PARTS[topic]
    for bad in (raw[:-1], raw[:12], b"", raw + bytes(16)):
        with pytest.raises((LayoutError, CommandError), match=topic.name):
            layout.blocks(bad)


def test_covariances_are_kept_in_the_canonical_form():
    """What a third party wrote into ignored fields stays in the log and does not disturb decoding."""
    message = parse(BASE_ODOM.type, PARTS[BASE_ODOM])
    message.pose.covariance = np.arange(36.0)
    store = typestore()
    raw = bytes(store.serialize_cdr(message, BASE_ODOM.type))
    _, data = TopicBytes(values.NAMES).read(BASE_ODOM, raw)
    assert data == raw
    assert LAYOUTS[BASE_ODOM].blocks(raw) == LAYOUTS[BASE_ODOM].blocks(PARTS[BASE_ODOM])


@pytest.mark.parametrize("little_endian", [True, False])
def test_other_layouts_take_the_general_path(little_endian):
    """Another frame or byte order is kept in content and becomes canonical, with its stamp."""
    message = parse(BASE_ODOM.type, PARTS[BASE_ODOM])
    message.child_frame_id = "tool0"
    message.header.stamp.sec = 5
    store = typestore()
    raw = bytes(store.serialize_cdr(message, BASE_ODOM.type, little_endian=little_endian))
    stamp, data = TopicBytes(values.NAMES).read(BASE_ODOM, raw + bytes(5))
    assert stamp == 5_000_000_000
    assert data == bytes(store.serialize_cdr(message, BASE_ODOM.type, little_endian=True))
    with pytest.raises(LayoutError, match=r"base/odom.child_frame_id.*'tool0'.*'base_link'"):
        StateCodec(values.NAMES).decode_part(0, data)


def test_empty_arrays_with_trailing_bytes_take_the_general_path():
    """A Float64MultiArray without data, four bytes too long as Fast DDS makes it, is read and is then exact."""
    message = parse(CONTROLLER_TELEMETRY.type, PARTS[CONTROLLER_TELEMETRY])
    message.layout.dim, message.data = [], np.empty(0)
    raw = bytes(typestore().serialize_cdr(message, CONTROLLER_TELEMETRY.type))
    assert len(raw) == 16
    assert canonical_message(CONTROLLER_TELEMETRY.type, raw + b"\xaa\xbb\xcc\xdd") == raw
    with pytest.raises(LayoutError, match="stamp"):
        TopicBytes(values.NAMES).read(CONTROLLER_TELEMETRY, raw)


@quick
@given(raw=st.binary(max_size=200))
def test_noise_is_refused_by_every_path(raw):
    """Arbitrary bytes are a LayoutError for a recorder, never another exception."""
    for topic in (JOINT_STATES, WRENCH_COMMAND, CONTROLLER_TELEMETRY):
        try:
            TopicBytes(values.NAMES).read(topic, raw)
        except LayoutError:
            continue
        # A wrench is nearly anything long enough; then it is at least stable.
        stamp, data = TopicBytes(values.NAMES).read(topic, raw)
        assert TopicBytes(values.NAMES).read(topic, data) == (stamp, data)


@quick
@given(cut=st.integers(0, 400), at=st.integers(0, 300), byte=st.integers(0, 255))
def test_damaged_messages_never_raise_anything_else(cut, at, byte):
    """A real message that is cut or has one byte changed is read or is a LayoutError."""
    for topic, raw in PARTS.items():
        bad = raw[:at] + bytes([byte]) + raw[at + 1 :]
        for damaged in (raw[:cut], bad):
            try:
                _, data = TopicBytes(values.NAMES).read(topic, damaged)
            except LayoutError:
                continue
            assert canonical_message(topic.type, data) == data


def test_big_endian_is_refused_by_the_fast_path():
    """A big-endian message is named as such."""
    raw = PARTS[WRENCH_COMMAND]
    with pytest.raises(CommandError, match=r"encapsulation.*00 00"):
        CommandCodec(values.NAMES).decode_part(0, b"\0\0" + raw[2:])


def test_stack_is_decode_row_by_row():
    """Cutting many messages at once gives the arrays that decoding each one gives."""
    codec = StateCodec(values.NAMES)
    states = [tick.sample.state for tick in values.run_ticks(5)]
    raws = [codec.encode(state)[1] for state in states]
    _, position, velocity, effort = codec.layouts[1].stack(raws)
    for row, raw in enumerate(raws):
        stamp, arrays = codec.layouts[1].decode(raw)
        assert stamp == states[row].stamp
        assert [a.tobytes() for a in arrays] == [a[row].tobytes() for a in (position, velocity, effort)]
        assert all(array.flags.aligned and not array.flags.writeable for array in arrays)


def test_stack_names_the_message_that_does_not_fit():
    """One message of other joints among many is found."""
    mine, other = StateCodec(("aa", "bb")), StateCodec(("aa", "bc"))
    state = values.run_ticks(1, n=2)[0].sample.state
    raws = [mine.encode(state)[1], other.encode(state)[1]]
    with pytest.raises(LayoutError, match=r"joint_states\.name\[1\].*'bc'"):
        mine.layouts[1].stack(raws)
    with pytest.raises(LayoutError, match="joint_states"):
        mine.layouts[1].stack([raws[0], raws[0][:-8]])


def test_encode_refuses_arrays_of_another_size():
    """Every hole is filled exactly."""
    layout = LayoutBuilder("t").stamp().sequence(3, "data").build()
    assert layout.decode(layout.encode(5, np.arange(3.0)))[1][0].tolist() == [0, 1, 2]
    with pytest.raises(LayoutError, match=r"t\.data.*got 2.*accepted: 3"):
        layout.encode(5, np.zeros(2))


def test_names_with_nul_are_refused():
    """A name CDR would cut is refused when the layout is made."""
    with pytest.raises(LayoutError, match="NUL"):
        StateCodec(("a\0b",))


def test_messages_of_a_robot_without_joints_round_trip():
    """A satellite without an arm round-trips too, and rosbags agrees with its bytes."""
    codec, telemetry = TickCodec(()), TelemetryCodec(CONTROLLER_TELEMETRY)
    tick = values.run_ticks(1, n=0)[0]
    parts = codec.encode(tick)
    assert values.bits(codec.decode({t.name: raw for t, raw in zip(LOGGED, parts, strict=True)})) == values.bits(tick)
    for topic, raw in zip(LOGGED, parts, strict=True):
        assert canonical_message(topic.type, raw) == raw
    assert telemetry.decode([parts[LOGGED.index(CONTROLLER_TELEMETRY)]]).labels == ("error", "gain")
