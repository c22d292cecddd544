"""Messages of others, joints in any order and among others, frames left empty: the same content in our layout."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from space_robot_msgs_py.codec.cdr import TIME
from space_robot_msgs_py.codec.generic import parse, serialise
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.errors import LayoutError, SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector

# Where a joint message has its names.
_NAMES = {"sensor_msgs/msg/JointState": "name", "trajectory_msgs/msg/JointTrajectory": "joint_names"}


def conformed(layout: Layout, ros_type: str, raw: bytes) -> bytes:
    """The canonical bytes of a message in the layout of this robot.

    Joints are found by name: any order, others among them, and what the layout does not have may be filled or not. The
    frame of joints means nothing; that of another message may be empty, which is then ours.

    Args:
        layout: of this robot's messages on the topic.
        ros_type: ``package/msg/Name``.
        raw: CDR of either byte order that does not have the layout.

    Raises:
        LayoutError: it cannot be done, and why (CommandError in the layout of a command).
    """
    try:
        message = parse(ros_type, raw)
    except LayoutError:
        # It is not such a message at all: the layout knows where it goes wrong.
        layout.blocks(raw)
        raise
    if ros_type in _NAMES:
        return _joints(layout, message, getattr(message, _NAMES[ros_type]), _NAMES[ros_type])
    found = serialise(ros_type, _framed(message, layout.texts))
    layout.blocks(found)
    return found


def _framed(message: Any, expected: Mapping[str, str]) -> Any:
    """The message with our frames where it has none."""
    if not message.header.frame_id and "header.frame_id" in expected:
        message = replace(message, header=replace(message.header, frame_id=expected["header.frame_id"]))
    if "child_frame_id" in expected and not message.child_frame_id:
        message = replace(message, child_frame_id=expected["child_frame_id"])
    return message


def _joints(layout: Layout, message: Any, names: Sequence[str], key: str) -> bytes:
    joints = [text for name, text in layout.texts.items() if name.startswith(f"{key}[")]
    order = _order(layout, names, joints, key)
    if key == "joint_names":
        _check_point(layout, message.points)
    arrays = [_array(layout, message, name, len(names))[order] for name in layout.arrays]
    time = message.header.stamp
    return layout.fill(TIME.pack(time.sec, time.nanosec), *(array.tobytes() for array in arrays))


def _check_point(layout: Layout, points: Sequence[Any]) -> None:
    """A reference is one point, for the time of its stamp."""
    if len(points) != 1:
        raise _wrong(layout, "not one point", "points", len(points), "1")
    after = points[0].time_from_start
    if after.sec or after.nanosec:
        late = after.sec + after.nanosec / NANOSECONDS
        raise _wrong(layout, "a point of another time", "points[0].time_from_start", late, "0 s")


def _order(layout: Layout, names: Sequence[str], joints: Sequence[str], key: str) -> list[int]:
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise _wrong(layout, "a joint is named twice", key, ", ".join(twice), "each joint once")
    places = {name: place for place, name in enumerate(names)}
    missing = [joint for joint in joints if joint not in places]
    if missing:
        accepted = f"{', '.join(joints)}, in any order; missing: {', '.join(missing)}"
        raise _wrong(layout, "joints are missing", key, ", ".join(names), accepted)
    return [places[joint] for joint in joints]


def _array(layout: Layout, message: Any, name: str, size: int) -> Vector:
    holder, _, field = name.rpartition(".")
    array: Vector = np.asarray(getattr(message.points[0] if holder else message, field), dtype=np.float64)
    if array.size != size:
        raise _wrong(layout, "wrong size", name, array.size, f"{size} numbers, one for each name")
    return array


def _wrong(layout: Layout, what: str, field: str, value: object, accepted: str) -> SpaceRobotError:
    return layout.error(what, key=f"{layout.topic}.{field}", value=value, accepted=accepted)
