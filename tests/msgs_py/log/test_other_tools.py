"""A log is what other tools of its format expect: rosbags, mcap, rosbag2; and it has nothing of this machine."""

from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from ruamel.yaml import YAML

from space_robot_msgs_py.attitude import SOURCES
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.mcap.records import MESSAGE
from space_robot_msgs_py.log.preamble import log_name
from tests.support import values
from tests.support.counted_log import BY_TICK, COUNT, records_in


def test_rosbags_reads_the_directory_without_a_gap(run):
    """AnyReader opens the bag by its metadata and decodes every message, with stamps as bag times."""
    with AnyReader([run]) as reader:
        assert reader.message_count == 1 + COUNT * len(BY_TICK)
        assert {c.topic: c.msgcount for c in reader.connections} == {
            "/robot_description": 1, "/tf": 0, "/tf_static": 0, **{log_name(topic): COUNT for topic in BY_TICK}
        }  # fmt: skip
        seen = {c.topic: [] for c in reader.connections}
        for connection, timestamp, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            seen[connection.topic].append(timestamp)
            if hasattr(message, "header"):
                stamp = message.header.stamp
                assert stamp.sec * NANOSECONDS + stamp.nanosec == timestamp
    for topic in BY_TICK:
        assert seen[log_name(topic)] == [k * values.PERIOD for k in range(COUNT)]


def test_rosbags_reads_the_bare_file_and_its_qos(run):
    """The .mcap alone is a bag too, and its channels carry the QoS that was offered."""
    with Reader(run / "run_0.mcap") as reader:
        assert reader.message_count == 1 + COUNT * len(BY_TICK)
        for connection in reader.connections:
            (offer,) = connection.ext.offered_qos_profiles
            for_tools = ("/tf", *(log_name(topic) for topic in SOURCES))
            depths = {"/robot_description": 1, "/tf_static": 1, **dict.fromkeys(for_tools, 10)}
            depth = depths.get(connection.topic, 1000)
            durability = "VOLATILE" if connection.topic in for_tools else "TRANSIENT_LOCAL"
            assert (offer.history.name, offer.depth, offer.reliability.name) == ("KEEP_LAST", depth, "RELIABLE")
            assert (offer.durability.name, offer.liveliness.name) == (durability, "AUTOMATIC")


def test_mcap_reads_every_message_with_valid_checksums(run):
    """The reference reader seeks, validates every checksum, and mcap_ros2 decodes every message."""
    with (run / "run_0.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary, header = reader.get_summary(), reader.get_header()
        decoded = list(reader.iter_decoded_messages())
        joints = list(reader.iter_messages(topics=["/joint_states"]))
        attachments = {a.name: a.data.decode() for a in reader.iter_attachments()}
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
    assert (header.profile, len(decoded)) == ("ros2", 1 + COUNT * len(BY_TICK))
    assert [message.log_time for _, _, message in joints] == [k * values.PERIOD for k in range(COUNT)]
    assert [message.sequence for _, _, message in joints] == list(range(COUNT))
    assert all(message.publish_time == message.log_time for _, _, message, _ in decoded)
    assert all(schema.encoding == "ros2msg" for schema in summary.schemas.values())
    assert all(channel.metadata["topic_type_hash"].startswith("RIHS01_") for channel in summary.channels.values())
    assert attachments == {"experiment.yaml": values.HEADER.experiment, "robot.urdf": values.HEADER.urdf}
    assert metadata["end"] == {"reason": "completed", "ticks": str(COUNT)}
    assert list(metadata) == ["space_robot", "end"]
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}


def test_metadata_yaml_agrees_with_the_file(run):
    """metadata.yaml has version 9, the counts of the file, the stamps as times, and the remarks."""
    data = YAML(typ="safe").load((run / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert (data["version"], data["storage_identifier"], data["ros_distro"]) == (9, "mcap", "jazzy")
    assert data["relative_file_paths"] == ["run_0.mcap"]
    assert data["duration"]["nanoseconds"] == (COUNT - 1) * values.PERIOD
    assert data["message_count"] == sum(topic["message_count"] for topic in data["topics_with_message_count"])
    assert data["custom_data"] == {"mode": "test", "end_reason": "completed"}
    assert data["topics_with_message_count"][1]["topic_metadata"]["offered_qos_profiles"][0]["depth"] == 1000


def test_nothing_of_this_machine_is_in_the_file(killed):
    """The plain file begins with its header and carries no time but stamps."""
    times = set()
    for opcode, content in records_in(killed):
        if opcode == Opcode.MESSAGE:
            _, _, log_time, publish_time = MESSAGE.unpack_from(content)
            times |= {log_time, publish_time}
    assert times == {k * values.PERIOD for k in range(COUNT)}
