"""The node that keeps everything: complete ticks, in table order, canonical bytes, on disk before the next one."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any, Protocol

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.subscription import Subscription
from rclpy.time import Time

from space_robot_msgs_py.codec.codecs import LOGGED, TopicBytes, decode_string, encode_clock
from space_robot_msgs_py.errors import CommandError, LogError, SpaceRobotError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import BASE_ODOM, RECORDER_CREDIT, ROBOT_DESCRIPTION, Topic

WINDOW = 50
EARLY = 64
# The simulator may be so many ticks ahead of what is on the disk. Where the recorder can die alone, no further than the
# tick that is being recorded, or what it had heard would be lost with it.
AHEAD_IN_ONE_PROCESS, AHEAD_BESIDE = 256, 0
ROLL_CALL_SECONDS = 0.02
GRACE_SECONDS = 1.0


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
    Nothing is lost: the simulator starts when the recorder hears every topic (a controller of somebody else may have
    no telemetry: it gets a second) and never runs more than ``ahead`` ticks ahead of what is written, which is well
    inside the depth of the queues. After ``~/reset`` a new log begins, once the first state of the new run is heard;
    messages that overtook it are kept (``EARLY`` ticks).

    Args:
        open_writer: gives the writer of the k-th log of this run, k = 0 first.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run; the log ends with tick ``steps``.
        lossless: every topic there is will speak at every stamp (lock-step); False: a stamp may miss some (paced), it
            is then written after ``WINDOW`` ticks as it is; a topic whose publisher comes later is expected from then.
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
        self._next = 0
        self._newest_state = -1
        self.lossless, self._ahead = lossless, ahead
        self._early: dict[int, dict[Topic, bytes]] = {}
        self._urdf: str | None = None
        self._pending: dict[int, dict[Topic, bytes]] = {}
        self._expected = {topic for topic in LOGGED if not topic.sporadic}
        self._canonical = TopicBytes(joint_names)
        self.closed = False
        self.heard = 0
        self.gaps = 0
        self.malformed = 0
        self.listen(ROBOT_DESCRIPTION, self._on_description)
        heard = [topic for topic in LOGGED if not topic.optional or topic in optional]
        listeners = {topic: self._listen_recorded(topic) for topic in heard}
        self._readers = {topic: one for topic, one in listeners.items() if topic in {*self._expected, *optional}}
        self._credit_publisher = self.publisher(RECORDER_CREDIT)
        self._given = -1
        self._clock_of_calls = Clock(clock_type=ClockType.STEADY_TIME)
        self._present_since: Time | None = None
        self._started = False
        self._roll_call = self.create_timer(ROLL_CALL_SECONDS, self._call_roll, clock=self._clock_of_calls)

    @property
    def complete(self) -> bool:
        """True when the last tick of the run is written."""
        return self._next > self._last

    @property
    def written_until(self) -> int:
        """Stamp of the newest tick in the log [ns]; -1: none."""
        return self._next - self._period if self._next else -1

    def finish(self, reason: str) -> str:
        """Write what is left of the ticks the robot reached and close the log; later calls do nothing.

        Returns:
            The reason; where the log cannot be written, that.
        """
        if not self.closed and not isinstance(self.failure, LogError):
            self.closed = True
            try:
                for stamp in sorted(self._pending):
                    if stamp <= self._newest_state:
                        self._write(stamp)
                self._writer.close(reason)
            except LogError as error:
                self.fail(error)
        self.closed = True
        return f"{self.get_name()}: {self.failure}" if isinstance(self.failure, LogError) else reason

    def _call_roll(self) -> None:
        """Let the run start once every required topic has a publisher and the optional ones had their second."""
        absent = {topic for topic, reader in self._readers.items() if reader.get_publisher_count() == 0}
        if self._started:
            # Paced: a controller that appears later is waited for from then on.
            self._expected |= {topic for topic in self._readers.keys() - absent if not topic.sporadic}
            return
        optional = {"controller_telemetry"} if self.lossless else {"controller_telemetry", "command", "reference"}
        if any(topic.kind not in optional for topic in absent):
            self._present_since = None
            return
        now = self._clock_of_calls.now()
        self._present_since = self._present_since or now
        if absent and (now - self._present_since).nanoseconds < GRACE_SECONDS * 1e9:
            return
        self._expected -= absent
        self._started = True
        if self.lossless:
            self._roll_call.cancel()
        self._give_credit()

    def _give_credit(self) -> None:
        """Half of what was given is still unused when the next comes: nobody waits for it."""
        reach = self._next + self._ahead * self._period
        if reach >= self._given + self._ahead // 2 * self._period:
            self._given = reach
            self._credit_publisher.publish(encode_clock(reach))

    def _listen_recorded(self, topic: Topic) -> Subscription:
        def on_message(raw: bytes) -> None:
            self.heard += 1
            if self.closed:
                return
            try:
                stamp, data = self._canonical.read(topic, raw)
            except SpaceRobotError as error:
                self._refuse(topic, error)
                return
            if stamp % self._period == 0 and 0 <= stamp <= self._last:
                self._take_in(topic, stamp, data)
            else:
                self._refuse(topic, CommandError("not a tick of this run", key=topic.name, value=f"{stamp} ns"))

        return self.listen(topic, on_message)

    def _refuse(self, topic: Topic, error: Exception) -> None:
        self.malformed += 1
        if self.malformed == 1:
            self.get_logger().warning(f"not recorded, a message on {topic.name}: {error}")

    def _on_description(self, raw: bytes) -> None:
        if self._urdf is None:
            self._urdf = decode_string(raw)
            self._writer.write_description(self._urdf)
            self._write_complete()

    def _take_in(self, topic: Topic, stamp: int, data: bytes) -> None:
        if topic is BASE_ODOM:
            if stamp < self._newest_state:
                self._start_new_log()
            self._newest_state = stamp
        if stamp < self._next:
            if stamp < EARLY * self._period:
                self._early.setdefault(stamp, {})[topic] = data
            return
        parts = self._pending.setdefault(stamp, {})
        parts[topic] = data
        # The count first: it is nearly always the answer, and every message asks.
        if len(parts) >= len(self._expected) or not self.lossless:
            self._write_complete()

    def _write_complete(self) -> None:
        if self._urdf is None:
            return
        while self._has_all(self._pending.get(self._next)):
            self._write(self._next)
        while not self.lossless and self._newest_state >= self._next + WINDOW * self._period:
            self.gaps += 1
            self._write(self._next)

    def _has_all(self, parts: dict[Topic, bytes] | None) -> bool:
        return parts is not None and parts.keys() >= self._expected

    def _write(self, stamp: int) -> None:
        parts = self._pending.pop(stamp, {})
        self._writer.write_tick(stamp, parts)
        self._next = stamp + self._period
        self._give_credit()

    def _start_new_log(self) -> None:
        """The plant was reset: what is complete stays in its log, the new run gets its own."""
        self.finish("reset")
        self._logs += 1
        self._writer = self._open_writer(self._logs)
        self._pending, self._early = self._early, {}
        self._newest_state, self._next, self._given, self.closed = -1, 0, -1, False
        self._give_credit()
        if self._urdf is not None:
            self._writer.write_description(self._urdf)
