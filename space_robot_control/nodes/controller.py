"""The node that carries a control law: it reacts to states and owns no timer."""

from __future__ import annotations

from typing import Any

from rclpy.duration import Duration

from space_robot_msgs_py.codecs import (
    CommandCodec,
    ReferenceCodec,
    StateCodec,
    TelemetryCodec,
    encode_events,
    peek_stamp,
)
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Controller, ControlOutput, Reference, RobotState
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.base import GraphNode, publish_all
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, CONTROLLER_TELEMETRY, Topic

JOIN_CAPACITY = 1024
HEARING_SECONDS = 5.0


class ControllerNode(GraphNode):
    """Joins state and reference of equal stamp, asks the law, publishes command and telemetry under the same stamp.

    Args:
        controller: the law, ready made.
        joint_names: the robot's joints in model order.
        name: node name.
        options: see GraphNode.
    """

    def __init__(
        self, controller: Controller, joint_names: tuple[str, ...], *, name: str = "controller", **options: Any
    ) -> None:
        super().__init__(name, **options)
        self._controller = controller
        self._state = StateCodec(joint_names)
        self._reference = ReferenceCodec(joint_names)
        self._command = CommandCodec(joint_names)
        self._telemetry = TelemetryCodec(CONTROLLER_TELEMETRY)
        self._last_stamp = -1
        self.malformed = 0
        self._command_publishers = [self.publisher(topic) for topic in self._command.topics]
        self._telemetry_publisher = self.publisher(CONTROLLER_TELEMETRY)
        self._event_publisher = self.publisher(CONTROLLER_EVENTS)
        inputs = (*self._state.topics, *self._reference.topics)
        self._joiner: StampJoiner[bytes] = StampJoiner(len(inputs), JOIN_CAPACITY, once=False)
        self._controller.reset()
        for index, topic in enumerate(inputs):
            self._listen_part(index, topic)

    def _listen_part(self, index: int, topic: Topic) -> None:
        def on_part(raw: bytes) -> None:
            try:
                joined = self._joiner.add(index, peek_stamp(raw), raw)
                values = None if joined is None else self._decode(joined)
            except SpaceRobotError as error:
                self._refuse(topic, error)
                return
            if values is not None:
                self._answer(*values)

        self.listen(topic, on_part)

    def _refuse(self, topic: Topic, error: Exception) -> None:
        self.malformed += 1
        if self.malformed == 1:
            self.get_logger().warning(f"refused a message on {topic.name}: {error}")

    def _decode(self, parts: tuple[bytes, ...]) -> tuple[RobotState, Reference]:
        split = len(self._state.topics)
        return self._state.decode(parts[:split]), self._reference.decode(parts[split:])

    def _answer(self, state: RobotState, reference: Reference) -> None:
        if state.stamp <= self._last_stamp:
            self._controller.reset()
        self._last_stamp = state.stamp
        try:
            output = self._controller.update(state, reference)
        except SpaceRobotError as error:
            self.fail(error)
            return
        self._send(output)

    def _send(self, output: ControlOutput) -> None:
        if output.events:
            self._event_publisher.publish(encode_events(output.events))
            # Topics have no order among each other, and a recorder that has all of a tick waits for nothing more.
            self._event_publisher.wait_for_all_acked(Duration(seconds=HEARING_SECONDS))
        # Telemetry first: when the plant has stepped, everything that belongs to the step before is on its way.
        self._telemetry_publisher.publish(self._telemetry.encode(output.telemetry)[0])
        publish_all(self._command_publishers, self._command.encode(output.command))
