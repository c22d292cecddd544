"""The numbers of a message by the names its definition gives them, for comparing and showing messages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_msgs_py.codec.topic_bytes import telemetry_codecs, value_layouts
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.topics import Topic

_XYZ, _XYZW = ("x", "y", "z"), ("x", "y", "z", "w")
# Block of a layout -> names of its numbers, as in the message definition.
_NUMBERS: dict[str, tuple[str, ...]] = {
    "pose.pose": (*(f"position.{c}" for c in _XYZ), *(f"orientation.{c}" for c in _XYZW)),
    "twist.twist": (*(f"linear.{c}" for c in _XYZ), *(f"angular.{c}" for c in _XYZ)),
    "accel": (*(f"linear.{c}" for c in _XYZ), *(f"angular.{c}" for c in _XYZ)),
    "wrench": (*(f"force.{c}" for c in _XYZ), *(f"torque.{c}" for c in _XYZ)),
    "orientation": _XYZW,
    "angular_velocity": _XYZ,
    "linear_acceleration": _XYZ,
    "vector": _XYZ,
}


class MessageFields:
    """Cuts the canonical messages of a tick into named blocks of numbers.

    Args:
        joint_names: the robot's joints in model order.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._joints = tuple(joint_names)
        self._layouts = value_layouts(joint_names)
        self._telemetry = telemetry_codecs()

    def blocks(self, topic: Topic, raw: bytes) -> dict[str, Vector]:
        """The numbers of a message by block, without stamp and covariances.

        Raises:
            LayoutError: the message does not fit the topic (CommandError for commands).
        """
        telemetry = self._telemetry.get(topic)
        if telemetry is not None:
            labels, sizes = telemetry.shape(raw)
            data = np.frombuffer(telemetry.layout_of(raw).blocks(raw)[1])
            edges = np.cumsum((0, *sizes)).tolist()
            return {label: data[a:b] for label, a, b in zip(labels, edges[:-1], edges[1:], strict=True)}
        layout = self._layouts[topic]
        names = [field.name for field in layout.fields if field.kind == "doubles"]
        return {name: np.frombuffer(block) for name, block in zip(names, layout.blocks(raw)[1:], strict=True)}

    def name(self, topic: Topic, block: str, index: int, size: int) -> str:
        """What one number is called, e.g. ``wrench.torque.x``, ``effort[joint2]``, ``estimate[3]``."""
        if topic in self._telemetry:
            return block if size == 1 else f"{block}[{index}]"
        if block in _NUMBERS:
            return f"{block}.{_NUMBERS[block][index]}"
        return f"{block}[{self._joints[index]}]"
