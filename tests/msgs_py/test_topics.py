import json
import sys
from pathlib import Path

import pytest

from space_robot_msgs_py.codec.schemas import KNOWN, known_types, schema_text, type_hash, typestore
from space_robot_msgs_py.docs import topics_markdown
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.qos import LOCK_STEP_DEPTH, OF_A_STATE, asked_of, qos_of, qos_of_states
from space_robot_msgs_py.topics import TABLE
from tests.support.paths import ROOT

DOCS = ROOT / "docs" / "topics.md"
TYPES = sorted({topic.type for topic in TABLE})


def test_docs_are_the_table():
    """docs/topics.md is what the table generates."""
    assert DOCS.read_text(encoding="utf-8") == topics_markdown()


def test_names_are_unique():
    """No two rows share a name."""
    assert len({topic.name for topic in TABLE}) == len(TABLE)


def test_no_recorded_topic_depends_on_the_wall_clock():
    """Nothing that depends on the wall clock is recorded."""
    assert all(topic.deterministic for topic in TABLE if topic.recorded)


def test_values_survive_late_joiners():
    """Every topic of the loop is reliable and deeper than a burst; latched ones keep one message."""
    for topic in TABLE:
        offer = qos_of(topic)
        assert offer.reliability == "reliable"
        if topic.kind != "tool":
            assert (offer.durability, offer.depth) == ("transient_local", 1 if topic.latched else 1000)


def test_states_and_commands_are_asked_for_as_ros_offers_them():
    """VOLATILE is enough; a simulator keeps a few states in lock-step, and none in a paced run, where they mislead."""
    assert all(asked_of(topic).reliability == "reliable" for topic in TABLE)
    assert all(asked_of(topic).durability == "transient_local" for topic in TABLE if topic.latched)
    volatile = {topic.name for topic in TABLE if asked_of(topic).durability == "volatile" and topic.kind != "tool"}
    assert {"base/odom", "joint_states", "base/imu", "plant/telemetry", "base/wrench_command"} <= volatile
    assert not {"reference/base", "accepted_command", "run_begin", "controller/telemetry"} & volatile
    for topic in TABLE:
        paced, lock_step = (qos_of_states(topic, paced=paced) for paced in (True, False))
        if topic.kind not in OF_A_STATE:
            assert paced == lock_step == qos_of(topic)
        else:
            assert (paced.durability, paced.depth) == ("volatile", 1000)
            assert (lock_step.durability, lock_step.depth) == ("transient_local", LOCK_STEP_DEPTH)


@pytest.mark.parametrize("ros_type", TYPES)
def test_schemas_are_complete(ros_type):
    """A schema text defines every type it mentions: rosbags and mcap_ros2 parse it from nothing."""
    from mcap_ros2._dynamic import generate_dynamic
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema_text(ros_type), ros_type))
    assert store.fielddefs[ros_type][1] == typestore().fielddefs[ros_type][1]
    assert store.hash_rihs01(ros_type) == type_hash(ros_type)
    assert ros_type in generate_dynamic(ros_type, schema_text(ros_type))


@pytest.mark.ros
@pytest.mark.parametrize("ros_type", TYPES)
def test_hashes_are_those_of_the_installed_messages(ros_type):
    """The type hash is the one ROS itself puts beside the message."""
    pytest.importorskip("rclpy")
    package, _, name = ros_type.split("/")
    description = Path(sys.prefix) / "share" / package / "msg" / f"{name}.json"
    if not description.is_file():
        pytest.skip("messages are installed elsewhere")
    hashes = {entry["type_name"]: entry["hash_string"] for entry in json.loads(description.read_text())["type_hashes"]}
    assert type_hash(ros_type) == hashes[ros_type]


def test_unknown_types_are_refused():
    """A type Jazzy does not have is a LayoutError."""
    for function in (schema_text, type_hash):
        with pytest.raises(LayoutError, match="no_msgs/msg/None"):
            function("no_msgs/msg/None")


def test_the_types_of_the_table_are_known_as_rosbags_has_them() -> None:
    """A log is written without loading it; write ``known_types`` of the table into ``KNOWN`` where this differs."""
    assert KNOWN.read_text("utf-8") == known_types(topic.type for topic in TABLE)
