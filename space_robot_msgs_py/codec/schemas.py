"""What a log must say about its types: complete definitions and hashes, from rosbags and so without ROS."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from space_robot_msgs_py.errors import LayoutError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


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
    _require(ros_type)
    return typestore().generate_msgdef(ros_type, ros_version=2)[0]


@cache
def type_hash(ros_type: str) -> str:
    """The ``RIHS01_...`` hash (REP 2016).

    Raises:
        LayoutError: Jazzy has no such type.
    """
    _require(ros_type)
    return typestore().hash_rihs01(ros_type)


def _require(ros_type: str) -> None:
    if ros_type not in typestore().fielddefs:
        raise LayoutError("unknown message type", value=ros_type, accepted="package/msg/Name of ROS 2 Jazzy")
