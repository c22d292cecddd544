"""Guidance node: publishes references ahead of the states they are for."""

from __future__ import annotations

from typing import Any

from space_robot_msgs_py.codec.codecs import ReferenceCodec, peek_stamp
from space_robot_msgs_py.interfaces import ReferenceSource
from space_robot_msgs_py.nodes.base import GraphNode, publish_all
from space_robot_msgs_py.topics import BASE_ODOM


class GuidanceNode(GraphNode):
    """Publishes the reference of every tick up to ``ahead`` ticks before the robot gets there.

    A reference is a function of time, so the controller never waits for it.

    Args:
        reference: the motion, ready made.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run; ticks 0..steps get a reference.
        ahead: how many ticks ahead [-].
        options: see GraphNode.
    """

    def __init__(
        self,
        reference: ReferenceSource,
        joint_names: tuple[str, ...],
        *,
        period: int,
        steps: int,
        ahead: int = 16,
        name: str = "guidance",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._reference = reference
        self._codec = ReferenceCodec(joint_names)
        self._period, self._steps, self._ahead = period, steps, ahead
        self._next = self._reached = 0
        self._reference_publishers = [self.publisher(topic) for topic in self._codec.topics]
        self._publish_until(ahead)
        self.listen(BASE_ODOM, self._on_state)

    def _on_state(self, raw: bytes) -> None:
        tick = peek_stamp(raw) // self._period
        if tick < self._reached:
            # The plant was reset: time starts again, and so do the references.
            self._next = tick
        self._reached = tick
        self._publish_until(tick + self._ahead)

    def _publish_until(self, tick: int) -> None:
        while self._next <= min(tick, self._steps):
            publish_all(self._reference_publishers, self._codec.encode(self._reference.at(self._next * self._period)))
            self._next += 1
