"""Tools we did not write read our bags: every message decodes, nothing is missing."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.topics import TABLE

TICKS = 161
EVERY_TICK = {
    topic.name.lstrip("/")
    for topic in TABLE
    if topic.recorded and not (topic.latched or topic.sporadic or topic.optional)
}


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("bags") / "fig08"
    run_experiment(load_experiment("liu2023/fig08"), directory, mode="headless")
    return directory


def test_rosbags_reads_the_directory_and_the_bare_file(bag: Path) -> None:
    """AnyReader decodes every message of the run directory and of the .mcap alone."""
    for path in (bag, next(bag.glob("*.mcap"))):
        counts: Counter[str] = Counter()
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
            for connection, stamp, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                if hasattr(message, "header"):
                    header = message.header.stamp
                    assert header.sec * 1_000_000_000 + header.nanosec == stamp
                counts[connection.topic.lstrip("/")] += 1
        assert [counts.pop(name) for name in ("robot_description", "tf_static")] == [1, 1]
        assert counts == dict.fromkeys(EVERY_TICK, TICKS)


def test_the_mcap_reader_with_its_ros2_decoder_reads_it(bag: Path) -> None:
    """The mcap library finds an index, no gap in any sequence, and decodes every message by the schema in the file."""
    counts: Counter[str] = Counter()
    with next(bag.glob("*.mcap")).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary is not None
        assert summary.chunk_indexes
        last = -1
        for _schema, channel, message, decoded in reader.iter_decoded_messages():
            assert decoded is not None
            assert message.sequence == counts[channel.topic]
            assert message.log_time >= last
            last = message.log_time
            counts[channel.topic] += 1
    assert set(counts.values()) == {1, TICKS}
