"""Joint messages are matched by name: what others send in their order is the same value."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import CommandCodec, ReferenceCodec, StateCodec, TopicBytes
from space_robot_msgs_py.codec.generic import parse, serialise
from space_robot_msgs_py.codec.schemas import typestore
from space_robot_msgs_py.errors import CommandError, LayoutError, NonFiniteError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState
from space_robot_msgs_py.topics import (
    BASE_ODOM,
    JOINT_COMMAND,
    JOINT_STATES,
    REFERENCE_JOINTS,
    WRENCH_COMMAND,
    Topic,
)

NAMES = ("shoulder", "elbow", "wrist")
STAMP = 3_250_000_000
Q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.2, 0.3])
COMMAND = Command(STAMP, np.arange(6.0), np.array([0.5, -0.5, 0.25]))
STATE = RobotState(STAMP, Q, np.arange(9.0), np.array([1.0, 2.0, 3.0]), np.zeros(3))
REFERENCE = Reference(STAMP, Q, np.arange(9.0), np.arange(9.0) + 1.0)
CODECS: dict[Topic, tuple[Any, int, Any]] = {
    JOINT_COMMAND: (CommandCodec(NAMES), 1, COMMAND),
    JOINT_STATES: (StateCodec(NAMES), 1, STATE),
    REFERENCE_JOINTS: (ReferenceCodec(NAMES), 2, REFERENCE),
}
orders = st.permutations([*NAMES, "gripper", "camera"]).flatmap(
    lambda names: st.integers(0, 2).map(lambda left_out: [n for n in names if n in NAMES or left_out < 1])
)


def arrays_of(topic: Topic, message: Any) -> tuple[Any, tuple[str, ...]]:
    """What has the arrays of a joint message, and which."""
    if topic is REFERENCE_JOINTS:
        return message.points[0], ("positions", "velocities", "accelerations", "effort")
    return message, ("position", "velocity", "effort")


def sent_by_others(topic: Topic, names: list[str], frame: str = "", *, filled: bool = True) -> bytes:
    """The message of the value with its joints in another order, others among them, and every array filled."""
    codec, part, value = CODECS[topic]
    raw = codec.encode(value)[part]
    message = parse(topic.type, raw)
    holder, fields = arrays_of(topic, message)
    own = list(message.joint_names if topic is REFERENCE_JOINTS else message.name)
    for field in fields:
        known = dict(zip(own, getattr(holder, field), strict=False))
        if known or filled:
            setattr(holder, field, np.array([known.get(name, 7.0) for name in names]))
    if topic is REFERENCE_JOINTS:
        message.joint_names = names
    else:
        message.name = names
    message.header.frame_id = frame
    return serialise(topic.type, message)


@settings(deadline=None, max_examples=40)
@given(topic=st.sampled_from([*CODECS]), names=orders, frame=st.sampled_from(["", "world"]), filled=st.booleans())
def test_any_order_and_other_joints_are_the_same_value(
    topic: Topic, names: list[str], frame: str, filled: bool
) -> None:
    """Live and in a log: the same blocks, and canonical bytes equal to those of the robot's own message."""
    codec, part, value = CODECS[topic]
    own, theirs = codec.encode(value)[part], sent_by_others(topic, names, frame, filled=filled)
    assert codec.decode_part(part, theirs) == codec.decode_part(part, own)
    assert codec.finite_blocks(part, theirs) == codec.finite_blocks(part, own)
    assert TopicBytes(NAMES).read(topic, theirs) == (STAMP, own)


@pytest.mark.parametrize("topic", [*CODECS])
@pytest.mark.parametrize(
    ("names", "why"),
    [
        (["wrist", "elbow"], "missing: shoulder"),
        (["wrist", "elbow", "shoulder", "elbow"], "named twice; got 'elbow'"),
        ([], "missing: shoulder, elbow, wrist"),
    ],
)
def test_missing_joints_and_duplicates_are_refused(topic: Topic, names: list[str], why: str) -> None:
    """With the topic, what there is and what is wrong."""
    codec, part, _ = CODECS[topic]
    error = CommandError if topic is JOINT_COMMAND else LayoutError
    with pytest.raises(error, match=f"{topic.name}.*{why}"):
        codec.decode_part(part, sent_by_others(topic, names))


def test_arrays_that_do_not_fit_the_names_are_refused() -> None:
    """An effort for fewer joints than names; one that is not used may be of any length."""
    message = parse(JOINT_COMMAND.type, sent_by_others(JOINT_COMMAND, ["wrist", "elbow", "shoulder", "gripper"]))
    message.velocity = np.zeros(2)
    CODECS[JOINT_COMMAND][0].decode_part(1, serialise(JOINT_COMMAND.type, message))
    message.effort = message.effort[:3]
    with pytest.raises(CommandError, match=r"joint_command\.effort.*got 3.*4 numbers"):
        CODECS[JOINT_COMMAND][0].decode_part(1, serialise(JOINT_COMMAND.type, message))


def test_nan_counts_where_it_is_used() -> None:
    """In an effort of the robot it is refused; that of a gripper, or a position of a command, is not looked at."""
    codec = CODECS[JOINT_COMMAND][0]
    message = parse(JOINT_COMMAND.type, sent_by_others(JOINT_COMMAND, ["gripper", "wrist", "elbow", "shoulder"]))
    message.effort, message.position = np.array([np.nan, 0.1, 0.2, 0.3]), np.full(4, np.nan)
    codec.finite_blocks(1, serialise(JOINT_COMMAND.type, message))
    message.effort = np.array([0.1, np.nan, 0.2, 0.3])
    with pytest.raises(NonFiniteError, match="joint_command"):
        codec.finite_blocks(1, serialise(JOINT_COMMAND.type, message))


def test_a_reference_of_another_time_is_refused() -> None:
    """A point that is not for the stamp, or more than one, is no reference of a tick."""
    codec = CODECS[REFERENCE_JOINTS][0]
    message = parse(REFERENCE_JOINTS.type, sent_by_others(REFERENCE_JOINTS, ["wrist", "elbow", "shoulder"]))
    message.points[0].time_from_start.sec = 1
    with pytest.raises(LayoutError, match="time_from_start"):
        codec.decode_part(2, serialise(REFERENCE_JOINTS.type, message))
    message.points = [message.points[0]] * 2
    with pytest.raises(LayoutError, match=r"points.*got 2"):
        codec.decode_part(2, serialise(REFERENCE_JOINTS.type, message))


def test_an_empty_frame_is_ours_and_another_one_is_not() -> None:
    """A wrench without a frame acts at the base; in the frame of the tool it would be another wrench."""
    codec = CommandCodec(NAMES)
    wrench, state = codec.encode(COMMAND)[0], StateCodec(NAMES).encode(STATE)[0]
    message, odometry = parse(WRENCH_COMMAND.type, wrench), parse(BASE_ODOM.type, state)
    message.header.frame_id = odometry.child_frame_id = ""
    assert codec.decode_part(0, serialise(WRENCH_COMMAND.type, message)) == codec.decode_part(0, wrench)
    raw = bytes(typestore().serialize_cdr(odometry, BASE_ODOM.type, little_endian=False))
    assert StateCodec(NAMES).decode_part(0, raw) == StateCodec(NAMES).decode_part(0, state)
    message.header.frame_id = "tool0"
    with pytest.raises(CommandError, match=r"frame_id.*'tool0'.*'base_link'"):
        codec.decode_part(0, serialise(WRENCH_COMMAND.type, message))
