"""The run directory as rosbag2 wants it, and what may be replaced in it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.preamble import RECORDED, log_name, signature
from space_robot_msgs_py.bounded_files import read_text, short
from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.limits import METADATA_BYTES
from space_robot_msgs_py.log.preamble import RECORDED, log_name, signature
from space_robot_msgs_py.qos import qos_of, yaml_text
from space_robot_msgs_py.codec.schemas import type_hash

METADATA_FILE = "metadata.yaml"
BAG_SUFFIX = "_0.mcap"
TEMPORARY = ".tmp"


def prepare_directory(directory: Path) -> Path:
    """Make a run directory, remove a previous run from it, and return the path of the new bag file.

    Raises:
        LogError: something else is in it, or it cannot be made.
    """
    try:
        place = directory.resolve()
        if place.exists():
            _remove_previous(place)
        place.mkdir(parents=True, exist_ok=True)
    except LogError:
        raise
    except (OSError, RuntimeError, ValueError) as error:
        # Before Python 3.13 a loop of links is a RuntimeError; a null byte in a name is a ValueError.
        reason = getattr(error, "strerror", None) or str(error)
        raise LogError(f"no run directory can be made here: {reason}", key=short(directory)) from None
    if not place.name:
        raise LogError("a run directory needs a name", key=str(directory))
    return place / f"{place.name}{BAG_SUFFIX}"


@dataclass(frozen=True, slots=True)
class BagTopic:
    """What ``metadata.yaml`` says about a topic.

    Attributes:
        name: as in the bag.
        type: ``package/msg/Name``.
        count: of its messages.
        qos: what was offered, as rosbag2 writes it.
        type_hash: ``RIHS01_...``, or empty.
    """

    name: str
    type: str
    count: int
    qos: tuple[Mapping[str, Any], ...] = ()
    type_hash: str = ""


def recorded_topics(counts: Mapping[str, int]) -> list[BagTopic]:
    """The topics of a run log with the number of messages by topic name."""
    return [
        BagTopic(log_name(topic), topic.type, counts[topic.name], (qos_of(topic).as_rosbag2(),), type_hash(topic.type))
        for topic in RECORDED
    ]


def write_metadata_yaml(
    path: Path, topics: Sequence[BagTopic], *, last_stamp: int, custom: Mapping[str, str], first_stamp: int = 0
) -> None:
    """Write ``metadata.yaml`` beside a bag file, version 9 as rosbag2 of Jazzy does.

    Args:
        path: the bag file.
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
                "serialization_format": "cdr",
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
        "relative_file_paths": [path.name],
        "files": [{"path": path.name, "starting_time": start, "duration": duration, "message_count": total}],
        "custom_data": dict(custom) or None,
        "ros_distro": "jazzy",
    }
    target = path.with_name(METADATA_FILE)
    temporary = target.with_name(METADATA_FILE + TEMPORARY)
    with temporary.open("w", encoding="utf-8") as stream:
        stream.write(yaml_text({"rosbag2_bagfile_information": information}))
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(target)


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


def _remove_previous(place: Path) -> None:
    if not place.is_dir():
        raise LogError("this is a file", key=str(place), accepted="a directory, new, empty or of an earlier run")
    bags = sorted(place.glob(f"*{BAG_SUFFIX}"))
    if any(place.iterdir()) and not (bags and all(map(_is_ours, bags))):
        raise LogError("not empty and not a run directory", key=str(place), accepted="a new or empty directory")
    temporaries = [bag.with_name(bag.name + TEMPORARY) for bag in bags]
    # The description goes first: a kill in between must not leave one that describes another bag.
    for path in (place / METADATA_FILE, *temporaries, *bags):
        path.unlink(missing_ok=True)


def _is_ours(path: Path) -> bool:
    """Began by this project; also an empty file, which is what a kill right after opening leaves."""
    expected = signature()
    with path.open("rb") as stream:
        return expected.startswith(stream.read(len(expected)))
