"""Supervisor node: decides on the mode of every state before the controller answers it; owns no timer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from std_srvs.srv import Trigger

from space_robot_msgs_py.codec.codecs import (
    AcceptedCodec,
    SupervisionCodec,
    TelemetryCodec,
    decode_statuses,
    encode_tick_housekeeping,
    encode_tick_statuses,
    peek_stamp,
    says_none,
)
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import ControlOutput, Reference, RobotState, Supervision, SupervisorUnit, Telemetry
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.nodes.tick_inputs import JOIN_CAPACITY, TickInputs
from space_robot_msgs_py.topics import (
    ACCEPTED_COMMAND,
    CONTROLLER_TELEMETRY,
    EVENTS,
    HOUSEKEEPING,
    PLANT_EVENTS,
    SUPERVISOR_MODE,
    WHEEL_MOMENTUM,
    Topic,
)
from space_robot_supervisor.rows import COMMANDS

Waiting = tuple[RobotState, Reference, tuple[bytes, ...]]


class SupervisorNode(ManagedNode):
    """Joins state and reference of equal stamp, lets the supervisor decide, publishes events, housekeeping and mode.

    In lock-step it waits for the answer to the state before, too, as the simulator accepted it, so that what it knows
    does not depend on who was faster; paced, it takes the newest one that was accepted, which is in the log. Commands
    of the ground are services of std_srvs/Trigger, ``~/standby``, ``~/nominal``, ``~/hold``, ``~/safe`` and ``~/stop``:
    answered at once, in force at the next tick.

    Deactivated it decides nothing, and the controller, which waits for it, answers nothing: a lock-step run stands
    still, a paced one goes on in the plant's hold.

    Args:
        make_supervisor: builds the supervisor, each time the node is configured.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        optional: the optional topics of this run.
        lossless: every state is answered before the next one comes (lock-step).
        telemetry: wait for the controller's telemetry, too.
        monitored: wait for the events of the plant's command monitor, too.
        name: node name.
        options: see ManagedNode.
    """

    def __init__(
        self,
        make_supervisor: Callable[[], SupervisorUnit],
        joint_names: tuple[str, ...],
        *,
        period: int,
        optional: Sequence[Topic] = (),
        lossless: bool = True,
        telemetry: bool = True,
        monitored: bool = False,
        name: str = "supervisor",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._make_supervisor, self._period, self._lossless = make_supervisor, period, lossless
        self._summarises = HOUSEKEEPING in optional
        self._modes, self._summaries = SupervisionCodec(), TelemetryCodec(HOUSEKEEPING)
        self._telemetry = TelemetryCodec(CONTROLLER_TELEMETRY)
        # Of the newest state: heard, decided on.
        self._heard = self._last_stamp = -1
        self._waiting: Waiting | None = None
        self._answer: ControlOutput | None = None
        beside = [(PLANT_EVENTS, peek_stamp)] if monitored else []
        self._inputs = TickInputs(self, joint_names, self._take_in, beside, wheels=WHEEL_MOMENTUM in optional)
        self._accepted = AcceptedCodec()
        answers = (ACCEPTED_COMMAND, *([CONTROLLER_TELEMETRY] if telemetry else []))
        self._answers: StampJoiner[Any] = StampJoiner(len(answers), JOIN_CAPACITY, once=False)
        for index, topic in enumerate(answers):
            self._listen_answer(index, topic)
        self.keep()

    @property
    def begun(self) -> bool:
        """True when a state was heard."""
        return self._heard >= 0

    def configure(self) -> None:
        """Build the supervisor; a state that comes before it is activated waits."""
        self._supervisor = self._make_supervisor()
        self._mode = ""
        self._event_publisher = self.publisher(EVENTS)
        self._summary_publisher = self.publisher(HOUSEKEEPING) if self._summarises else None
        self._mode_publisher = self.publisher(SUPERVISOR_MODE)
        for command in COMMANDS:
            self.create_service(Trigger, f"~/{command}", partial(self._on_command, command))

    def activate(self) -> None:
        """Decide on the state that waits."""
        self._decide()

    def cleanup(self) -> None:
        """Forget the supervisor."""
        del self._supervisor

    def begin_again(self) -> None:
        """Answers of the run before are none of the new one."""
        self._answers.clear()
        self._answer = None
        self._inputs.forget()

    def _listen_answer(self, index: int, topic: Topic) -> None:
        def on_part(raw: bytes) -> None:
            try:
                stamp, part = self._read_answer(topic, raw)
            except SpaceRobotError as error:
                self.refuse(topic, error)
                return
            joined = None if part is None else self._answers.add(index, stamp, part)
            if joined is not None:
                self._take_answer(stamp, joined)

        self.listen(topic, on_part)

    def _read_answer(self, topic: Topic, raw: bytes) -> tuple[int, Any]:
        """Stamp [ns] and content of a part of an answer; None where it is none."""
        if topic is CONTROLLER_TELEMETRY:
            telemetry = self._telemetry.decode((raw,))
            return telemetry.stamp, telemetry
        said = self._accepted.decode(raw)
        return said.stamp, None if said.too_late else said.command

    def _take_answer(self, stamp: int, parts: Sequence[Any]) -> None:
        if stamp > self._heard:
            # An answer to a state that was not heard: of the run before.
            return
        telemetry = parts[1] if len(parts) > 1 else Telemetry.of(stamp, {})
        if self._answer is None or stamp > self._answer.command.stamp:
            self._answer = ControlOutput(parts[0], telemetry)
        self._decide()

    def _take_in(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        if state.stamp <= self._heard:
            self._answers.clear()
            self._answer = None
            self._last_stamp = -1
        self._heard = state.stamp
        self._waiting = state, reference, beside
        self._decide()

    def _decide(self) -> None:
        """Decide on the state that waits, once all is known that should be."""
        if self._waiting is None or not self.active:
            return
        state, reference, beside = self._waiting
        known = -1 if self._answer is None else self._answer.command.stamp
        if self._lossless and state.stamp > 0 and known < state.stamp - self._period:
            return
        self._waiting = None
        if self._last_stamp < 0:
            self._supervisor.reset()
        self._last_stamp = state.stamp
        try:
            events = [event for raw in beside if not says_none(raw) for event in decode_statuses(raw)]
            found = self._supervisor.update(state, reference, self._answer, events)
        except SpaceRobotError as error:
            self.fail(error)
            return
        self._send(found)

    def _send(self, found: Supervision) -> None:
        # At every tick: the recorder waits for what it expects only. Last the mode, which the controller awaits.
        self._event_publisher.publish(encode_tick_statuses(found.stamp, found.events))
        if self._summary_publisher is not None:
            summary = encode_tick_housekeeping(self._summaries, found.stamp, found.housekeeping)
            self._summary_publisher.publish(summary)
        self._mode_publisher.publish(self._modes.encode(found))
        if self._mode and found.mode != self._mode:
            self.get_logger().info(f"{self._mode} -> {found.mode} at {found.stamp} ns")
        self._mode = found.mode

    def _on_command(self, command: str, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if not self.active or self.end_reason is not None:
            return fill(response, success=False, message="the supervisor is not active")
        said = self._supervisor.order(command)
        return fill(response, success=said.accepted, message=said.reason)
