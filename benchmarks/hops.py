"""The hops of a lock-step tick with rclpy alone: what publishing, taking and taking turns cost before anything is done.

Four nodes, the ten messages of a tick as ready bytes, on the nineteen ways that they take in a run. A node that has all
it waits for reads the numbers of one message, adds one to them, and publishes what is its own. Nothing is checked,
joined by stamp, encoded or written.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future

from space_robot_msgs_py.codec.cdr import MAX_TRAILING
from space_robot_msgs_py.qos import asked_of, qos_of
from space_robot_msgs_py.ros import message_class, qos
from space_robot_msgs_py.topics import BASE_ODOM, Topic

# Who answers to what, once all of it is there.
HEARS = {
    "recorder": ("state", "reference", "command", "controller_telemetry", "plant_telemetry"),
    "guidance": ("state",),
    "controller": ("state", "reference"),
    "simulator": ("command",),
}


class Hop:
    """A node that answers when it has heard a message on each of its topics.

    Attributes:
        waits: for so many messages in a tick.

    Args:
        name: of the node.
        messages: of a tick.
        context: of the node.
        on_answer: called before it answers; False: it does not.
    """

    def __init__(
        self, name: str, messages: Mapping[Topic, bytes], context: Context, on_answer: Callable[[], bool]
    ) -> None:
        self.node = Node(name, context=context, start_parameter_services=False, enable_rosout=False)
        self._on_answer, self._heard = on_answer, 0
        heard = [BASE_ODOM] if name == "guidance" else [one for one in messages if one.kind in HEARS[name]]
        self.waits = len(heard)
        for topic in heard:
            kind, profile = message_class(topic), qos(asked_of(topic))
            self.node.create_subscription(kind, topic.name, self._take, profile, raw=True)
        self._says: list[tuple[Any, bytes]] = [
            (self.node.create_publisher(message_class(topic), topic.name, qos(qos_of(topic))), raw)
            for topic, raw in messages.items()
            if topic.publisher == name
        ]

    def answer(self) -> None:
        """Publish everything once."""
        for publisher, raw in self._says:
            publisher.handle.publish_raw(raw)

    def _take(self, raw: bytes) -> None:
        self._heard += 1
        if self._heard % self.waits == 0:
            size = (len(raw) - MAX_TRAILING) // 8
            _ = np.frombuffer(raw, dtype=np.float64, count=size) + 1.0
            if self._on_answer():
                self.answer()


def go_round(
    messages: Mapping[Topic, bytes], ticks: int, on_tick: Callable[[int], None], context: Context
) -> dict[str, int]:
    """Let the messages of a tick go round.

    Args:
        messages: of a tick, by topic.
        ticks: how often.
        on_tick: called with the number of each, from 1.
        context: of the nodes.

    Returns:
        How many messages each node takes in a tick.
    """
    over, tick = Future(), 0

    def step() -> bool:
        nonlocal tick
        tick += 1
        on_tick(tick)
        if tick >= ticks:
            over.set_result(None)
        return tick < ticks

    hops = {name: Hop(name, messages, context, step if name == "simulator" else lambda: True) for name in HEARS}
    executor = EventsExecutor(context=context)
    for hop in hops.values():
        executor.add_node(hop.node)
    hops["simulator"].answer()
    while not over.done():
        executor.spin_until_future_complete(over, timeout_sec=0.05)
    executor.shutdown()
    for hop in hops.values():
        hop.node.destroy_node()
    return {name: hop.waits for name, hop in hops.items()}
