"""Controller node: runs a law on every state; owns no timer."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

from rclpy.duration import Duration
from std_srvs.srv import Trigger

from space_robot_control.laws.base import Law
from space_robot_control.laws.guarded import guarded_update
from space_robot_control.laws.switching import ACTIVE, Switching
from space_robot_control.nodes.health import ControllerHealth
from space_robot_description.validation import parse_yaml_value
from space_robot_msgs_py.codec.codecs import (
    CommandCodec,
    ReferenceCodec,
    StateCodec,
    TelemetryCodec,
    encode_events,
    encode_statuses,
)
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, ControlOutput, Reference, RobotState
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.base import publish_all
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, CONTROLLER_TELEMETRY, EVENTS, Topic

JOIN_CAPACITY = 1024
HEARING_SECONDS = 5.0


class ControllerNode(ManagedNode):
    """Joins state and reference of equal stamp, updates the law, publishes command and telemetry under the same stamp.

    Dynamic gains are dynamic parameters; a change acts from the next state on and is published on ``controller/events``
    before the command it acts on. With laws in standby ``~/switch`` (std_srvs/Trigger) and the parameter
    ``active_law`` let another law take over.

    Deactivated it does not answer: a lock-step run stands still, a paced one goes on in the plant's hold. Activated
    again it answers the state that waits; if states passed without a command meanwhile, the law is reset.

    Args:
        make_law: builds the law, each time the node is configured.
        joint_names: the robot's joints in model order.
        supervised: a supervisor decides which law answers, and its events are published.
        name: node name.
        options: see ManagedNode.
    """

    def __init__(
        self,
        make_law: Callable[[], Law],
        joint_names: tuple[str, ...],
        *,
        supervised: bool = False,
        name: str = "controller",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._make_law, self._supervised = make_law, supervised
        self._state = StateCodec(joint_names)
        self._reference = ReferenceCodec(joint_names)
        self._command = CommandCodec(joint_names)
        self._telemetry = TelemetryCodec(CONTROLLER_TELEMETRY)
        self.malformed = 0

    def configure(self) -> None:
        """Build the law and listen; states that come before it is activated wait."""
        self._law = self._make_law()
        self._law.reset()
        self._health = ControllerHealth(self, self._law)
        self.parameters.declare(self._law.parameters())
        self._last_stamp, self._passed_by = -1, False
        self._waiting: tuple[RobotState, Reference] | None = None
        self._command_publishers = [self.publisher(topic) for topic in self._command.topics]
        self._telemetry_publisher = self.publisher(CONTROLLER_TELEMETRY)
        self._event_publisher = self.publisher(CONTROLLER_EVENTS)
        self._supervision_publisher = self.publisher(EVENTS) if self._supervised else None
        if isinstance(self._law, Switching):
            self.create_service(Trigger, "~/switch", self._on_switch)
        inputs = (*self._state.topics, *self._reference.topics)
        self._joiner: StampJoiner[bytes] = StampJoiner(len(inputs), JOIN_CAPACITY, once=False)
        for index, topic in enumerate(inputs):
            self._listen_part(index, topic)

    def activate(self) -> None:
        """Answer the newest state that waits."""
        if self._passed_by:
            self._law.reset_in_run()
            self._passed_by = False
        if self._waiting is not None:
            self._answer(*self._waiting)

    def cleanup(self) -> None:
        """Forget the law."""
        del self._law, self._health

    def retune(self, changes: dict[str, Any]) -> None:
        """Change gains or the active law from the next state on.

        Raises:
            SpecError: the law does not accept it.
        """
        self._law.tune({key: parse_yaml_value(v, key) if isinstance(v, str) else v for key, v in changes.items()})

    def _listen_part(self, index: int, topic: Topic) -> None:
        def on_part(raw: bytes) -> None:
            try:
                joined = self._joiner.add(index, self._peek(index, raw), raw)
                values = None if joined is None else self._decode(joined)
            except SpaceRobotError as error:
                self._refuse(topic, error)
                return
            if values is not None:
                self._take_in(*values)

        self.listen(topic, on_part)

    def _peek(self, index: int, raw: bytes) -> int:
        """The stamp of a part, in the order of the inputs."""
        split = len(self._state.topics)
        return self._state.peek(index, raw) if index < split else self._reference.peek(index - split, raw)

    def _refuse(self, topic: Topic, error: Exception) -> None:
        self.malformed += 1
        if self.malformed == 1:
            self.get_logger().warning(f"refused a message on {topic.name}: {error}")

    def _decode(self, parts: tuple[bytes, ...]) -> tuple[RobotState, Reference]:
        split = len(self._state.topics)
        return self._state.decode(parts[:split]), self._reference.decode(parts[split:])

    def _take_in(self, state: RobotState, reference: Reference) -> None:
        if self.active:
            self._answer(state, reference)
            return
        self._passed_by = self._passed_by or self._waiting is not None
        self._waiting = state, reference

    def _answer(self, state: RobotState, reference: Reference) -> None:
        self._waiting = None
        if state.stamp <= self._last_stamp:
            self._law.reset()
            self._show_active()
        self._last_stamp = state.stamp
        begun = perf_counter()
        try:
            output = guarded_update(self._law, state, reference, self._tick_of(state.stamp))
        except SpaceRobotError as error:
            self.fail(error)
            return
        self._health.answered(state.stamp, begun)
        self._send(output)

    def _tick_of(self, stamp: int) -> int:
        return round(stamp / (self._law.control_period * NANOSECONDS))

    def _send(self, output: ControlOutput) -> None:
        if output.supervision and self._supervision_publisher is not None:
            self._supervision_publisher.publish(encode_statuses(output.supervision))
            self._supervision_publisher.wait_for_all_acked(Duration(seconds=HEARING_SECONDS))
        if output.events:
            self._event_publisher.publish(encode_events(output.events))
            # Topics have no order among each other, and a recorder that has all of a tick waits for nothing more.
            self._event_publisher.wait_for_all_acked(Duration(seconds=HEARING_SECONDS))
        # Telemetry first: when the plant has stepped, everything that belongs to the step before is on its way.
        self._telemetry_publisher.publish(self._telemetry.encode(output.telemetry)[0])
        publish_all(self._command_publishers, self._command.encode(output.command))
        if output.events:
            self._show_active()
            for event in output.events:
                self.get_logger().info(event.line)

    def _show_active(self) -> None:
        if isinstance(self._law, Switching):
            self.parameters.show(ACTIVE, self._law.active)

    def _on_switch(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        assert isinstance(self._law, Switching)
        target = self._law.next_in_turn()
        self._law.switch_to(target)
        response.success = True
        response.message = f"{target} takes over from {self._law.active} at the next state"
        return response
