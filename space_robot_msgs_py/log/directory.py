"""The description of a bag, ``metadata.yaml``, as rosbag2 wants it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_msgs_py.bounded_files import read_text
from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.codec.schemas import type_hash
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.limits import METADATA_BYTES
from space_robot_msgs_py.log.preamble import RECORDED, log_name
from space_robot_msgs_py.qos import qos_of
from space_robot_msgs_py.yaml_text import yaml_text

METADATA_FILE = "metadata.yaml"
BAG_SUFFIX = "_0.mcap"
TEMPORARY = ".tmp"


@dataclass(frozen=True, slots=True)
class BagTopic:
    """What ``metadata.yaml`` says about a topic.

    Attributes:
        name: as in the bag.
        type: ``package/msg/Name``.
        count: of its messages.
        qos: what was offered, as rosbag2 writes it.
        type_hash: ``RIHS01_...``, or empty.
        encoding: of its messages.
    """

    name: str
    type: str
    count: int
    qos: tuple[Mapping[str, Any], ...] = ()
    type_hash: str = ""
    encoding: str = "cdr"


def recorded_topics(counts: Mapping[str, int]) -> list[BagTopic]:
    """The topics of a run log with the number of messages by topic name, for each that it has a channel of."""
    return [
        BagTopic(log_name(topic), topic.type, counts[topic.name], (qos_of(topic).as_rosbag2(),), type_hash(topic.type))
        for topic in RECORDED
        if topic.name in counts
    ]


def write_metadata_yaml(
    path: Path, topics: Sequence[BagTopic], *, last_stamp: int, custom: Mapping[str, str], first_stamp: int = 0
) -> None:
    """Write ``metadata.yaml`` beside a bag file; see ``metadata_yaml``."""
    target = path.with_name(METADATA_FILE)
    temporary = target.with_name(METADATA_FILE + TEMPORARY)
    span = {"last_stamp": last_stamp, "first_stamp": first_stamp}
    with temporary.open("wb") as stream:
        stream.write(metadata_yaml(path.name, topics, custom=custom, **span))
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(target)


def metadata_yaml(
    name: str, topics: Sequence[BagTopic], *, last_stamp: int, custom: Mapping[str, str], first_stamp: int = 0
) -> bytes:
    """The description of a bag, version 9 as rosbag2 of Jazzy writes it.

    Args:
        name: of the bag file beside it.
        topics: in it.
        last_stamp: of the bag [ns].
        custom: remarks.
        first_stamp: of the bag [ns].
    """
    start = {"nanoseconds_since_epoch": first_stamp}
    duration = {"nanoseconds": last_stamp - first_stamp}
    total = sum(topic.count for topic in topics)
    listed = [
        {
            "topic_metadata": {
                "name": topic.name,
                "type": topic.type,
                "serialization_format": topic.encoding,
                "offered_qos_profiles": [dict(offer) for offer in topic.qos],
                "type_description_hash": topic.type_hash,
            },
            "message_count": topic.count,
        }
        for topic in topics
    ]
    information = {
        "version": 9,
        "storage_identifier": "mcap",
        "duration": dict(duration),
        "starting_time": dict(start),
        "message_count": total,
        "topics_with_message_count": listed,
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [name],
        "files": [{"path": name, "starting_time": start, "duration": duration, "message_count": total}],
        "custom_data": dict(custom) or None,
        "ros_distro": "jazzy",
    }
    return yaml_text({"rosbag2_bagfile_information": information}).encode()


def description(place: Path) -> dict[str, Any]:
    """What ``metadata.yaml`` of a bag says; nothing where it is absent or unreadable, for the files say it too."""
    try:
        text = read_text(place / METADATA_FILE, METADATA_BYTES)
        data = load_yaml(text, METADATA_FILE)["rosbag2_bagfile_information"]
        return data if isinstance(data, dict) else {}
    except (SpaceRobotError, LookupError, TypeError):
        return {}


def custom_data(path: Path) -> dict[str, str]:
    """The remarks in the ``metadata.yaml`` beside a bag file, such as the mode; nothing where there are none."""
    custom = description(path.parent).get("custom_data")
    return {str(key): str(text) for key, text in custom.items()} if isinstance(custom, dict) else {}
