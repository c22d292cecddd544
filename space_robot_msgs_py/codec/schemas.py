"""What a log must say about its types: complete definitions and hashes, from rosbags and so without ROS."""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from space_robot_msgs_py.errors import LayoutError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


KNOWN = Path(__file__).with_name("schemas.json")


@cache
def typestore() -> Typestore:
    """The message types of ROS 2 Jazzy; loading them takes a third of a second, so it waits for the first need."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


@cache
def schema_text(ros_type: str) -> str:
    """The ``ros2msg`` schema: the definition followed by those of all types it uses.

    Raises:
        LayoutError: Jazzy has no such type.
    """
    if ros_type in _known():
        return _known()[ros_type]["text"]
    _require(ros_type)
    return typestore().generate_msgdef(ros_type, ros_version=2)[0]


@cache
def type_hash(ros_type: str) -> str:
    """The ``RIHS01_...`` hash (REP 2016).

    Raises:
        LayoutError: Jazzy has no such type.
    """
    if ros_type in _known():
        return _known()[ros_type]["hash"]
    _require(ros_type)
    return typestore().hash_rihs01(ros_type)


@cache
def _known() -> dict[str, dict[str, str]]:
    """Text and hash of the types of the table, as rosbags has them: it loads every type of every ROS since 2019."""
    known: dict[str, dict[str, str]] = json.loads(KNOWN.read_text("utf-8"))
    return known


def known_types(ros_types: Iterable[str]) -> str:
    """What stands in the file of known types for some types, out of rosbags."""
    store = typestore()
    rows = {
        name: {"hash": store.hash_rihs01(name), "text": store.generate_msgdef(name, ros_version=2)[0]}
        for name in sorted(set(ros_types))
    }
    return json.dumps(rows, indent=1) + "\n"


def _require(ros_type: str) -> None:
    if ros_type not in typestore().fielddefs:
        raise LayoutError("unknown message type", value=ros_type, accepted="package/msg/Name of ROS 2 Jazzy")
