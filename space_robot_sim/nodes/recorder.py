"""The node that keeps everything: complete ticks, in table order, canonical bytes, on disk before the next one."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any, Protocol

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.subscription import Subscription
from rclpy.time import Time

from space_robot_msgs_py.codec.codecs import (
    LOGGED,
    CommandCodec,
    TelemetryCodec,
    TopicBytes,
    decode_events,
    decode_string,
    encode_clock,
    encode_events,
    is_empty,
    peek_stamp,
    says_none,
)
from space_robot_msgs_py.codec.sender_mark import SenderMark
from space_robot_msgs_py.errors import LayoutError, LogError, SpaceRobotError
from space_robot_msgs_py.events import PUBLISHERS, ControllerEvent
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import ACCEPTED_COMMAND, CONTROLLER_EVENTS, RECORDER_CREDIT, ROBOT_DESCRIPTION, Topic
from space_robot_sim.nodes.credit import MAX_AHEAD
from space_robot_sim.nodes.publishers import Publishers
from space_robot_sim.nodes.tick_parts import COMMANDS, TickParts

# The simulator may be so many ticks ahead of what is on the disk. Where the recorder can die alone, no further than the
# tick that is being recorded, or what it had heard would be lost with it.
AHEAD_IN_ONE_PROCESS, AHEAD_BESIDE = MAX_AHEAD, 0
ROLL_CALL_SECONDS = 0.02
GRACE_SECONDS = 1.0
WATCH_SECONDS = 1.0


class TickWriter(Protocol):
    """Where the recorder writes: a LogWriter."""

    def write_description(self, urdf: str) -> None:
        """The robot, first of all."""

    def write_tick(self, stamp: int, parts: dict[Topic, bytes]) -> None:
        """All messages of one stamp."""

    def close(self, reason: str) -> None:
        """No more ticks."""


class RecorderNode(GraphNode):
    """Collects the messages of each stamp and writes a tick when all its topics are there.

    The order in the file is by stamp, then by table, whatever the order of arrival: equal runs give equal files.
    Nothing is lost: the simulator starts when the recorder hears every topic (a third-party controller may have
    no telemetry: it gets a second) and never runs more than ``ahead`` ticks ahead of what is written, which is well
    inside the depth of the queues. When the simulator says that the run begins again a new log begins, and then the
    simulator gets credit for the new run.

    Once a command topic has more than one publisher the commands in the log are those that the simulator says it
    accepted: which of two it heard first is known to it alone. A change of the nodes that publish a topic of a tick is
    logged as an event.

    Args:
        open_writer: gives the writer of the k-th log of this run, k = 0 first.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run; the log ends with tick ``steps``.
        lossless: every topic there is will speak at every stamp (lock-step); False: a stamp may miss some (paced), it
            is then written as it is, some ticks later; a topic whose publisher comes later is expected from then.
        ahead: ticks that the simulator may be ahead of the log; 0: state k comes when tick k - 1 is in the log.
        optional: the optional topics of this run, whose publishers have to be there, too.
        options: see GraphNode.
    """

    def __init__(
        self,
        open_writer: Callable[[int], TickWriter],
        joint_names: tuple[str, ...],
        *,
        period: int,
        steps: int,
        lossless: bool = True,
        ahead: int = AHEAD_IN_ONE_PROCESS,
        optional: Collection[Topic] = (),
        name: str = "recorder",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._open_writer, self._logs = open_writer, 0
        self._writer = open_writer(0)
        self._period, self._last = period, steps * period
        self._parts = TickParts(period, steps)
        self.lossless, self._ahead = lossless, ahead
        self._urdf: str | None = None
        self._canonical = TopicBytes(joint_names)
        self.closed = False
        self.heard = 0
        self.gaps = 0
        self._commands, self._accepted = CommandCodec(joint_names), TelemetryCodec(ACCEPTED_COMMAND)
        self._marks = SenderMark(self._commands.layouts)
        self.listen(ROBOT_DESCRIPTION, self._on_description)
        heard = [topic for topic in LOGGED if not topic.optional or topic in optional]
        listeners = {topic: self._listen_recorded(topic) for topic in heard}
        self._optional = frozenset(optional)
        self._parts.expected |= self._optional
        self._required = {topic: reader for topic, reader in listeners.items() if topic in self._parts.expected}
        # Of the handles themselves: they are asked at every tick.
        self._command_counts = [listeners[topic].handle.get_publisher_count for topic in self._commands.topics]
        self._speakers = Publishers(self, heard)
        self._news: list[dict[str, Any]] = []
        self._credit_publisher = self.publisher(RECORDER_CREDIT)
        self._given = -1
        self._clock_of_calls = Clock(clock_type=ClockType.STEADY_TIME)
        self._present_since: Time | None = None
        self._started = False
        self._roll_call = self.create_timer(ROLL_CALL_SECONDS, self._call_roll, clock=self._clock_of_calls)
        self._watch = self.create_timer(
            WATCH_SECONDS, self._watch_publishers, clock=self._clock_of_calls, autostart=False
        )

    @property
    def begun(self) -> bool:
        """True when the plant was heard."""
        return self._parts.reached >= 0 or self._logs > 0

    @property
    def malformed(self) -> int:
        """How many messages were not recorded because they do not fit."""
        return sum(self.refusals[topic.name] for topic in LOGGED)

    @property
    def complete(self) -> bool:
        """True when the last tick of the run is written."""
        return self._parts.next > self._last

    @property
    def written_until(self) -> int:
        """Stamp of the newest tick in the log [ns]; -1: none."""
        return self._parts.next - self._period if self._parts.next else -1

    def finish(self, reason: str) -> str:
        """Write what is left of the ticks the robot reached and close the log; later calls do nothing.

        Returns:
            The reason; where the log cannot be written, that.
        """
        if not self.closed and not isinstance(self.failure, LogError):
            self.closed = True
            try:
                for stamp, parts in self._parts.rest():
                    self._write(stamp, parts)
                self._writer.close(reason)
            except LogError as error:
                self.fail(error)
        self.closed = True
        return f"{self.get_name()}: {self.failure}" if isinstance(self.failure, LogError) else reason

    def _call_roll(self) -> None:
        """Let the run start once every required topic has a publisher and the optional ones had their second."""
        absent = {topic for topic, reader in self._required.items() if reader.get_publisher_count() == 0}
        if self._started:
            # Paced: a controller that appears later is waited for from then on.
            self._parts.expected |= {topic for topic in self._required.keys() - absent if not topic.sporadic}
            return
        optional = {"controller_telemetry"} if self.lossless else {"controller_telemetry", "command", "reference"}
        if any(topic.kind not in optional for topic in absent):
            self._present_since = None
            return
        now = self._clock_of_calls.now()
        self._present_since = self._present_since or now
        if absent and (now - self._present_since).nanoseconds < GRACE_SECONDS * 1e9:
            return
        self._parts.expected -= absent
        self._started = True
        self._watch_publishers()
        self._watch.reset()
        if self.lossless:
            self._roll_call.cancel()
        self._give_credit()

    def _give_credit(self) -> None:
        """Half of what was given is still unused when the next comes: nothing waits for it."""
        reach = self._parts.next + self._ahead * self._period
        if reach >= self._given + self._ahead // 2 * self._period:
            self._given = reach
            self._credit_publisher.publish(encode_clock(reach))

    def _listen_recorded(self, topic: Topic) -> Subscription:
        part = self._commands.topics.index(topic) if topic in COMMANDS else None

        def on_message(raw: bytes) -> None:
            self.heard += 1
            if self.closed or (part is not None and self._parts.contested):
                return
            try:
                if part is not None:
                    raw = self._marks.remove(part, raw)
                stamp, data = self._read(topic, raw)
            except SpaceRobotError as error:
                self.refuse(topic, error)
                return
            self._take_in(topic, stamp, data)

        return self.listen(topic, on_message)

    def _read(self, topic: Topic, raw: bytes) -> tuple[int, bytes]:
        if topic.optional and says_none(raw):
            return peek_stamp(raw), raw
        return self._canonical.read(topic, raw)

    def _on_accepted(self, raw: bytes) -> None:
        """Only once the command topics are contested: what the simulator took."""
        self.heard += 1
        if self.closed:
            return
        try:
            telemetry = self._accepted.decode((raw,))
            wrench, effort = telemetry["wrench"], telemetry["effort"]
            parts = self._commands.encode(Command(telemetry.stamp, wrench, effort)) if wrench.size else ()
        except SpaceRobotError as error:
            self.refuse(ACCEPTED_COMMAND, error)
            return
        if not parts:
            self._parts.hold(telemetry.stamp)
            self._write_complete()
        for topic, data in zip(self._commands.topics, parts, strict=False):
            self._take_in(topic, telemetry.stamp, data)

    def _on_description(self, raw: bytes) -> None:
        if self._urdf is not None:
            return
        try:
            self._urdf = decode_string(raw)
        except LayoutError as error:
            self.refuse(ROBOT_DESCRIPTION, error)
            return
        self._writer.write_description(self._urdf)
        self._write_complete()

    def _take_in(self, topic: Topic, stamp: int, data: bytes) -> None:
        refusal = self._parts.take(topic, stamp, data)
        if refusal is None:
            return
        if refusal:
            self.refuse(topic, refusal)
        else:
            self._write_complete()

    def _write_complete(self) -> None:
        while (complete := self._parts.complete()) or (not self.lossless and self._parts.over()):
            if self._urdf is None:
                return
            # Whatever is in a complete tick came from publishers that are known by now.
            if not self._parts.contested and self._has_rivals():
                self._contest()
            else:
                self.gaps += not complete
                self._write(*self._parts.pop())

    def _has_rivals(self) -> bool:
        wrench, joints = self._command_counts
        return bool(wrench() > 1 or joints() > 1)

    def _contest(self) -> None:
        """More than one node commands: from the next tick on, the log has what the simulator accepted."""
        self._parts.contest()
        self.listen(ACCEPTED_COMMAND, self._on_accepted)
        self._watch_publishers()

    def _watch_publishers(self) -> None:
        """Log which nodes publish a topic where that has changed, with the next tick."""
        try:
            for topic, nodes in self._speakers.changes():
                self.get_logger().warning(f"{topic.name} is now published by {', '.join(nodes)}")
                self._news.append({"topic": topic.name, "nodes": nodes})
        except Exception as error:
            self.fail(error)

    def _write(self, stamp: int, parts: dict[Topic, bytes]) -> None:
        if self._news:
            self._add_news(stamp, parts)
        for topic in self._optional:
            if topic in parts and is_empty(topic, parts[topic]):
                del parts[topic]
        self._writer.write_tick(stamp, parts)
        self._give_credit()

    def _add_news(self, stamp: int, parts: dict[Topic, bytes]) -> None:
        news = [ControllerEvent(stamp, PUBLISHERS, content) for content in self._news]
        own = decode_events(parts[CONTROLLER_EVENTS]) if CONTROLLER_EVENTS in parts else ()
        parts[CONTROLLER_EVENTS] = encode_events([*news, *own])
        self._news = []

    def begin_again(self) -> None:
        """The plant was reset: what is complete stays in its log, the new run gets its own."""
        if self.end_reason is not None:
            return
        self.finish("reset")
        if self.failure is not None:
            return
        self._logs += 1
        self._writer = self._open_writer(self._logs)
        self._parts.begin_again()
        self._given, self.closed = -1, False
        if self._urdf is not None:
            self._writer.write_description(self._urdf)
        if self._started:
            self._give_credit()
