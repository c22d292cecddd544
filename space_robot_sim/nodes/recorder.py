"""The node that keeps everything: complete ticks, in table order, canonical bytes, on disk before the next one."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from rclpy.subscription import Subscription

from space_robot_msgs_py.codec.codecs import LOGGED, Accepted, AcceptedCodec, CommandCodec, decode_string
from space_robot_msgs_py.errors import LayoutError, LogError, SpaceRobotError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import ACCEPTED_COMMAND, ROBOT_DESCRIPTION, Topic
from space_robot_sim.nodes.attendance import Attendance
from space_robot_sim.nodes.credit import AHEAD_IN_ONE_PROCESS, CreditGiver
from space_robot_sim.nodes.left_out import LeftOut
from space_robot_sim.nodes.message_readers import MessageReaders, Reader
from space_robot_sim.nodes.tick_parts import ANSWERS, COMMANDS, TickParts
from space_robot_sim.nodes.tick_writer import TickLog, TickWriter


class RecorderNode(GraphNode):
    """Collects the messages of each stamp and writes a tick when all its topics are there.

    The order in the file is by stamp, then by table, whatever the order of arrival: equal runs give equal files.
    Nothing is lost: the simulator starts when the recorder hears every topic (a third-party controller may have
    no telemetry: it gets a second) and never runs more than ``ahead`` ticks ahead of what is written, which is well
    inside the depth of the queues. When the simulator says that the run begins again a new log begins, and then the
    simulator gets credit for the new run.

    Once a command topic has more than one publisher, and in every paced run, the commands in the log are those that the
    simulator says it accepted: what acted is known to it alone. A change of the nodes that publish a topic of a tick is
    logged as an event.

    Paced, a tick waits for its command until the simulator accepts none for it any more, ``MAX_LATE`` periods. Of a
    command that comes later the log has the event that its state was answered; what else comes too late is counted.

    Args:
        open_writer: gives the writer of the k-th log of this run, k = 0 first.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run; the log ends with tick ``steps``.
        lossless: every topic there is will speak at every stamp (lock-step); False: a stamp may miss some (paced), it
            is then written as it is, some ticks later.
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
        self._log = TickLog(open_writer, period, optional, paced=not lossless)
        self._period, self._last = period, steps * period
        self._parts = TickParts(period, steps, paced=not lossless)
        self.lossless = lossless
        self._urdf: str | None = None
        self.closed, self._stood = False, -1
        self.heard = self.gaps = 0
        self._commands, self._accepted = CommandCodec(joint_names), AcceptedCodec()
        readers = MessageReaders(joint_names)
        self.listen(ROBOT_DESCRIPTION, self._on_description)
        heard = [topic for topic in LOGGED if not topic.optional or topic in optional]
        listeners = {topic: self._listen_recorded(topic, readers.of(topic)) for topic in heard}
        self._parts.expected |= frozenset(optional)
        self._parts.sample |= {topic for topic in optional if topic.kind == "state"}
        # Of the handles themselves: they are asked at every tick.
        self._command_counts = [listeners[topic].handle.get_publisher_count for topic in self._commands.topics]
        self._credit = CreditGiver(self, period, ahead)
        if not lossless:
            self.listen(ACCEPTED_COMMAND, self._on_accepted)
        self._attendance = Attendance(
            self,
            listeners,
            frozenset(self._parts.expected),
            lossless=lossless,
            on_start=self._start,
            on_watch=self._on_watch,
        )

    @property
    def begun(self) -> bool:
        """True when the plant was heard."""
        return self._parts.reached >= 0 or self._log.number > 0

    @property
    def left_out(self) -> LeftOut:
        """What the log lacks."""
        return self._log.left_out

    @property
    def malformed(self) -> int:
        """How many messages were not recorded because they do not fit."""
        return sum(self.refusals[topic.name] for topic in LOGGED)

    @property
    def complete(self) -> bool:
        """True when the last tick of the run is written."""
        return self._parts.next > self._last

    @property
    def awaits(self) -> bool:
        """True where a tick that the plant reached lacks what something that is there has still to send."""
        if self.closed or self.lossless:
            return not self.complete
        return any(map(self._attendance.has_publisher, self._parts.awaited() - COMMANDS))

    @property
    def written_until(self) -> int:
        """Stamp of the newest tick in the log [ns]; -1: none."""
        return self._parts.next - self._period if self._parts.next else -1

    def finish(self, reason: str) -> str:
        """Write what is left of the ticks the robot reached and close the log; later calls do nothing.

        Returns the reason; where the log cannot be written, that.
        """
        if not self.closed and not isinstance(self.failure, LogError):
            self.closed = True
            try:
                for stamp, parts in self._parts.rest():
                    self._log.write(stamp, parts, self._attendance.news())
                for line in self.left_out.report():
                    self.get_logger().warning(line)
                self._log.close(reason)
            except LogError as error:
                self.fail(error)
        self.closed = True
        return f"{self.get_name()}: {self.failure}" if isinstance(self.failure, LogError) else reason

    def _start(self, absent: frozenset[Topic]) -> None:
        """Everybody is there who has to be: let the run start."""
        if self.lossless:
            self._parts.expected -= absent
        elif self.publisher_count(ACCEPTED_COMMAND) == 0:
            # In place of the simulator there is something that does not tell.
            self._parts.contested = False
        self._give_credit()

    def _listen_recorded(self, topic: Topic, read: Reader) -> Subscription:
        parts, commands, answer = self._parts, topic in COMMANDS, topic.kind in ANSWERS

        def on_message(raw: bytes) -> None:
            self.heard += 1
            if self.closed or (commands and parts.contested):
                return
            try:
                stamp, data = read(raw)
            except SpaceRobotError as error:
                self.refuse(topic, error)
                return
            if answer and stamp < parts.next:
                self._note_late(topic)
            if (refusal := parts.take(topic, stamp, data)) is not None:
                self._go_on(topic, refusal)

        return self.listen(topic, on_message)

    def _on_accepted(self, raw: bytes) -> None:
        """What the simulator took: in a paced run, and once the command topics are contested."""
        self.heard += 1
        if self.closed:
            return
        try:
            said = self._accepted.decode(raw)
            parts = () if said.command is None else self._commands.encode(said.command)
        except SpaceRobotError as error:
            self.refuse(ACCEPTED_COMMAND, error)
            return
        if not self.lossless:
            self._note(said)
        elif not parts:
            self._parts.hold(said.stamp)
        for topic, data in zip(self._commands.topics, parts, strict=False):
            self._take_in(topic, said.stamp, data)
        if not parts:
            self._write_complete()

    def _note(self, said: Accepted) -> None:
        """Paced: what the simulator tells of a period, of which it tells in order."""
        if not said.too_late:
            self._parts.decide(said.stamp)
        if said.command is not None:
            if said.acting:
                self._log.note_acting(said.stamp, said.acting)
            if said.stamp < self._parts.next:
                self.left_out.add_answer(said.stamp)

    def _on_description(self, raw: bytes) -> None:
        if self._urdf is not None:
            return
        try:
            self._urdf = decode_string(raw)
        except LayoutError as error:
            self.refuse(ROBOT_DESCRIPTION, error)
            return
        self._log.write_description(self._urdf)
        self._write_complete()

    def _take_in(self, topic: Topic, stamp: int, data: bytes) -> None:
        if stamp < self._parts.next and topic.kind in ANSWERS:
            self._note_late(topic)
        if (refusal := self._parts.take(topic, stamp, data)) is not None:
            self._go_on(topic, refusal)

    def _note_late(self, topic: Topic) -> None:
        """Paced, an answer to a tick that is in the log is left out of it."""
        if not self.lossless:
            self.left_out.add(topic)

    def _go_on(self, topic: Topic, refusal: str) -> None:
        """See ``TickParts.take``."""
        if refusal:
            self.refuse(topic, refusal)
        else:
            self._write_complete()

    def _write_complete(self) -> None:
        while (complete := self._parts.complete()) or (not self.lossless and self._is_over()):
            if self._urdf is None:
                return
            # Whatever is in a complete tick came from publishers that are known by now.
            if self.lossless and not self._parts.contested and self._has_rivals():
                self._contest()
            else:
                self.gaps += not complete
                self._log.write(*self._parts.pop(), self._attendance.news())
                self._give_credit()
        if self._parts.next == 0:
            self._give_credit()

    def _give_credit(self) -> None:
        if self._attendance.started:
            self._credit.give(self._parts.next, heard=self._parts.reached >= 0)

    def _on_watch(self) -> None:
        """Paced, time may be over for a tick. In lock-step a command may be lost that the simulator has; or a node."""
        if not self.lossless:
            self._write_complete()
            return
        lacks = self._parts.lacks()
        stands = self._parts.next if lacks else -1
        if lacks and stands == self._stood:
            if lacks <= COMMANDS and not self._parts.contested:
                self._contest()
            elif not lacks & COMMANDS and not any(map(self._attendance.has_publisher, lacks)):
                # A controller without telemetry has taken the place of one with it.
                self._parts.give_up(lacks)
                self._write_complete()
        self._stood = stands

    def _is_over(self) -> bool:
        """Paced: whether the next tick stays as it is."""
        missing = self._parts.missing()
        if not missing:
            return True
        if missing & COMMANDS or not self._attendance.waited_long(self._parts.next, missing):
            return False
        self._parts.give_up(missing)
        return True

    def _has_rivals(self) -> bool:
        wrench, joints = self._command_counts
        return bool(wrench() > 1 or joints() > 1)

    def _contest(self) -> None:
        """More than one node commands: from the next tick on, the log has what the simulator accepted."""
        self._parts.contest()
        self.listen(ACCEPTED_COMMAND, self._on_accepted)
        self._attendance.look()

    def begin_again(self) -> None:
        """The plant was reset: what is complete stays in its log, the new run gets its own."""
        if self.end_reason is not None:
            return
        self.finish("reset")
        if self.failure is not None:
            return
        self._log.begin_again()
        self._parts.begin_again()
        self.closed = False
        self._credit.restart()
        if self._urdf is not None:
            self._log.write_description(self._urdf)
        self._give_credit()
