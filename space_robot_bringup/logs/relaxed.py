"""States of other tools as far as they can be drawn: frames of other names, joints without velocity or effort."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from space_robot_msgs_py.codec.generic import parse, serialise
from space_robot_msgs_py.codec.message_layouts import BASE_LINK, INERTIAL
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.topics import BASE_IMU, BASE_ODOM, JOINT_STATES, Topic


def relaxed(topic: Topic, raw: bytes) -> bytes:
    """A message of a state with what a drawing does not need put right; the same where it cannot be read.

    Pose and positions stay as they are. Frames become those of the project, and velocities and efforts that the
    message does not have become zero.

    Args:
        topic: ``base/odom``, ``joint_states`` or ``base/imu``.
        raw: canonical bytes.
    """
    try:
        message = parse(topic.type, raw)
    except LayoutError:
        return raw
    return serialise(topic.type, _RELAX[topic](message))


def _odometry(message: Any) -> Any:
    return replace(message, header=replace(message.header, frame_id=INERTIAL), child_frame_id=BASE_LINK)


def _joints(message: Any) -> Any:
    count = len(message.name)
    full = {name: getattr(message, name) for name in ("velocity", "effort")}
    return replace(message, **{name: array if len(array) else np.zeros(count) for name, array in full.items()})


def _imu(message: Any) -> Any:
    return replace(message, header=replace(message.header, frame_id=BASE_LINK))


_RELAX: dict[Topic, Callable[[Any], Any]] = {BASE_ODOM: _odometry, JOINT_STATES: _joints, BASE_IMU: _imu}
