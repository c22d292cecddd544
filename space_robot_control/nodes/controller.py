"""Controller node: runs a law on every state; owns no timer."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any, cast

from rclpy.duration import Duration
from std_srvs.srv import Trigger

from space_robot_control.laws.base import Law
from space_robot_control.laws.common_layout import ACTIVE
from space_robot_control.laws.guarded import guarded_update
from space_robot_control.laws.switching import Switching
from space_robot_control.nodes.health import ControllerHealth
from space_robot_description.validation import parse_yaml_value
from space_robot_msgs_py.codec.codecs import CommandCodec, SupervisionCodec, TelemetryCodec, encode_events
from space_robot_msgs_py.codec.sender_mark import UNMARKED, SenderMark
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, ControlOutput, Reference, RobotState, SupervisedController
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.nodes.sending import Send, sending
from space_robot_msgs_py.nodes.tick_inputs import TickInputs
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, CONTROLLER_TELEMETRY, SUPERVISOR_MODE, WRENCH_COMMAND

HEARING_SECONDS = 5.0


class ControllerNode(ManagedNode):
    """Joins state, reference and mode of equal stamp, updates the law, publishes command and telemetry of that stamp.

    Dynamic gains are dynamic parameters; a change acts from the next state on and is published on ``controller/events``
    before the command it acts on. With laws in standby ``~/switch`` (std_srvs/Trigger) and the parameter
    ``active_law`` let another law take over.

    Deactivated it does not answer: a lock-step run stands still, a paced one goes on in the plant's hold. Activated
    again it answers the state that waits; if states passed without a command meanwhile, the law is reset. States are
    heard as long as the node lives; configured anew in a run it begins with a new law, and keeps the gains that were
    tuned.

    Paced, it answers the newest state that it has heard of: one that is slower than the clock skips states, which is
    seen in the log, and does not fall behind.

    Args:
        make_law: builds the law, each time the node is configured.
        joint_names: the robot's joints in model order.
        paced: the clock does not wait for answers.
        supervised: a supervisor decides on the mode of every state, and the law is a ``SupervisedController``.
        wheels: states have the momentum of the wheels.
        name: node name.
        options: see ManagedNode.
    """

    def __init__(
        self,
        make_law: Callable[[], Law],
        joint_names: tuple[str, ...],
        *,
        paced: bool = False,
        supervised: bool = False,
        wheels: bool = False,
        name: str = "controller",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._make_law, self._supervised, self._paced = make_law, supervised, paced
        self._due = False
        self._command = CommandCodec(joint_names)
        self._marks = SenderMark(self._command.layouts)
        self._telemetry = TelemetryCodec(CONTROLLER_TELEMETRY)
        self._tuned: list[dict[str, Any]] = []
        self._last_stamp, self._passed_by = -1, False
        self._waiting: tuple[RobotState, Reference, tuple[bytes, ...]] | None = None
        self._modes = SupervisionCodec()
        beside = [(SUPERVISOR_MODE, self._read_mode)] if supervised else []
        self._inputs = TickInputs(self, joint_names, self._take_in, beside, self._answer_again, wheels=wheels)
        # The newest answer, and whom it was given by.
        self._said: tuple[int, list[tuple[Send, bytes]]] = -1, []
        self.keep()

    @property
    def begun(self) -> bool:
        """True when a state was heard."""
        return self._last_stamp >= 0 or self._waiting is not None

    @property
    def malformed(self) -> int:
        """How many messages were refused because they are no state or reference."""
        return self._inputs.malformed

    def configure(self) -> None:
        """Build the law; states that come before it is activated wait."""
        self._law = self._make_law()
        self._law.prepare()
        self._law.reset()
        for changes in self._tuned:
            self._law.tune(changes)
        # A new law knows nothing of the states before.
        self._passed_by = self._last_stamp >= 0
        self._health = ControllerHealth(self, self._law)
        self.parameters.declare(self._law.parameters())
        before = self.publishers_by_mark(WRENCH_COMMAND)
        self._command_senders = [sending(self.publisher(topic)) for topic in self._command.topics]
        # Another controller may come to be at the same time.
        own = self.get_fully_qualified_name()
        found = self.publishers_by_mark(WRENCH_COMMAND).items()
        mine = [mark for mark, name in found if name == own and mark not in before]
        self._mark = mine[0] if len(mine) == 1 else UNMARKED
        self._telemetry_sender = sending(self.publisher(CONTROLLER_TELEMETRY))
        self._event_publisher = self.publisher(CONTROLLER_EVENTS)
        if isinstance(self._law, Switching) and not self._supervised:
            self.create_service(Trigger, "~/switch", self._on_switch)

    def activate(self) -> None:
        """Answer the newest state that waits."""
        if self._passed_by:
            self._law.reset_in_run()
            self._passed_by = False
        if self._waiting is not None:
            self._answer(*self._waiting)

    def begin_again(self) -> None:
        """The first state comes again."""
        self._inputs.forget()

    def cleanup(self) -> None:
        """Forget the law."""
        self._said = -1, []
        del self._law, self._health

    def retune(self, changes: dict[str, Any]) -> None:
        """Change gains or the active law from the next state on.

        Raises:
            SpecError: the law does not accept it.
        """
        changes = {key: parse_yaml_value(v, key) if isinstance(v, str) else v for key, v in changes.items()}
        self._law.tune(changes)
        gains = {key: value for key, value in changes.items() if key != ACTIVE}
        self._tuned = [one for one in self._tuned if one.keys() != gains.keys()] + [gains] * bool(gains)

    def _read_mode(self, raw: bytes) -> int:
        """The stamp of a mode that the law has; before the law is there any may be it."""
        found = self._modes.decode(raw)
        if self.configured:
            cast(SupervisedController, self._law).check_decision(found)
        return found.stamp

    def _take_in(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        if self.active and not self._paced:
            self._answer(state, reference, beside)
            return
        self._passed_by = self._passed_by or (self._waiting is not None and not self.active)
        self._waiting = state, reference, beside
        if self.active and not self._due:
            # Behind all messages that are here already.
            self._due = True
            self.executor.create_task(self._answer_newest)

    def _answer_newest(self) -> None:
        self._due = False
        try:
            if self.active and self._waiting is not None and self.end_reason is None:
                self._answer(*self._waiting)
        except Exception as error:
            self.fail(error)

    def _answer(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        self._waiting = None
        if state.stamp <= self._last_stamp:
            self._law.reset()
            self._show_active()
        self._last_stamp = state.stamp
        for raw in beside:
            cast(SupervisedController, self._law).supervise(self._modes.decode(raw))
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
        telemetry = self._telemetry.encode(output.telemetry)[0]
        command = self._marks.put(self._command.encode(output.command), self._mark)
        said = [(self._telemetry_sender, telemetry), *zip(self._command_senders, command, strict=True)]
        self._said = output.command.stamp, said
        if output.events:
            self._event_publisher.publish(encode_events(output.events))
            # Topics have no order among each other, and a recorder that has all of a tick waits for nothing more.
            self._event_publisher.wait_for_all_acked(Duration(seconds=HEARING_SECONDS))
        # Telemetry first: when the plant has stepped, everything that belongs to the step before is on its way.
        for send, raw in said:
            send(raw)
        if output.events:
            self._show_active()
            for event in output.events:
                self.get_logger().info(event.line)

    def _answer_again(self, stamp: int) -> None:
        """A state that was answered waits still: the answer was lost on a node that did not hear this one yet."""
        if self.active and stamp == self._said[0]:
            for send, raw in self._said[1]:
                send(raw)

    def _show_active(self) -> None:
        if isinstance(self._law, Switching):
            self.parameters.show(ACTIVE, self._law.active)

    def _on_switch(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        assert isinstance(self._law, Switching)
        target = self._law.next_in_turn()
        self._law.switch_to(target)
        return fill(response, success=True, message=f"{target} takes over from {self._law.active} at the next state")
