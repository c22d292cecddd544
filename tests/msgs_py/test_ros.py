import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("rclpy")

from rclpy.qos import DurabilityPolicy, HistoryPolicy, ReliabilityPolicy
from rclpy.serialization import serialize_message

from space_robot_msgs_py import ros
from space_robot_msgs_py.codec.codecs import LOGGED, CommandCodec, ReferenceCodec, StateCodec, TelemetryCodec, TickCodec
from space_robot_msgs_py.codec.topic_bytes import TopicBytes
from space_robot_msgs_py.qos import qos_of
from space_robot_msgs_py.topics import BASE_ODOM, CONTROLLER_TELEMETRY, JOINT_COMMAND, JOINT_STATES, TABLE
from tests.support import values

pytestmark = pytest.mark.ros
quick = settings(deadline=None, max_examples=25)
KINDS = [(StateCodec, values.states), (ReferenceCodec, values.references), (CommandCodec, values.commands)]


def through_rclpy(codec, value):
    """What a node of rclpy that reads and sends on a value makes of its bytes: its own padding, its own order."""
    parts = zip(codec.topics, codec.encode(value), strict=True)
    return [serialize_message(ros.to_msg(topic, raw)) for topic, raw in parts]


@pytest.mark.parametrize(("codec_class", "strategy"), KINDS, ids=["state", "reference", "command"])
@quick
@given(data=st.data())
def test_values_become_messages_and_come_back(codec_class, strategy, data):
    """Value to rclpy messages to bytes, as rclpy serialises them, to value gives the same bits."""
    names = data.draw(values.joint_names())
    value = data.draw(strategy(len(names)))
    codec = codec_class(names)
    assert values.bits(codec.decode(through_rclpy(codec, value))) == values.bits(value)


@quick
@given(telemetry=values.telemetries())
def test_telemetry_becomes_a_message_and_comes_back(telemetry):
    """Telemetry to Float64MultiArray and back gives the same bits."""
    codec = TelemetryCodec(CONTROLLER_TELEMETRY)
    assert values.bits(codec.decode(through_rclpy(codec, telemetry))) == values.bits(telemetry)


def test_rclpy_reads_the_encoded_bytes_field_by_field():
    """What rclpy finds in our bytes is what the value says."""
    tick = values.run_ticks(1)[0]
    raws = dict(zip(LOGGED, TickCodec(values.NAMES).encode(tick), strict=True))
    odometry, joints, command = (ros.to_msg(topic, raws[topic]) for topic in (BASE_ODOM, JOINT_STATES, JOINT_COMMAND))
    state = tick.sample.state
    assert odometry.child_frame_id == "base_link"
    assert odometry.pose.pose.orientation.w == state.q[6]
    assert not odometry.pose.covariance.any()
    assert (tuple(joints.name), list(joints.velocity)) == (values.NAMES, state.joint_rates.tolist())
    assert (list(command.position), list(command.effort)) == ([], tick.output.command.effort.tolist())


@pytest.mark.parametrize("topic", LOGGED, ids=lambda topic: topic.name)
def test_bytes_of_rclpy_become_canonical(topic):
    """A message rclpy serialised, with whatever it left in the padding, becomes our bytes again."""
    raw = dict(zip(LOGGED, TickCodec(values.NAMES).encode(values.run_ticks(1)[0]), strict=True))[topic]
    msg = ros.to_msg(topic, raw)
    assert TopicBytes(values.NAMES).canonical(topic, serialize_message(msg)) == raw


@pytest.mark.parametrize("topic", [t for t in TABLE if not t.derived], ids=lambda topic: topic.name)
def test_profiles_are_those_of_the_table(topic):
    """Every row has a message class and a KEEP_LAST profile with the offered durability."""
    profile = ros.qos(qos_of(topic))
    volatile = topic.kind == "tool"
    assert ros.message_class(topic).__name__ == topic.type.rpartition("/")[2]
    assert (profile.history, profile.reliability) == (HistoryPolicy.KEEP_LAST, ReliabilityPolicy.RELIABLE)
    assert profile.durability == (DurabilityPolicy.VOLATILE if volatile else DurabilityPolicy.TRANSIENT_LOCAL)
