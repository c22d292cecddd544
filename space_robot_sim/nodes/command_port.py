"""Where commands enter the simulator: joined by stamp, checked, counted, refused where they do not fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.subscription import Subscription

from space_robot_msgs_py.codec.accepted import CONTROLLERS
from space_robot_msgs_py.codec.codecs import CommandCodec
from space_robot_msgs_py.codec.sender_mark import UNMARKED, SenderMark
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic
from space_robot_sim.nodes.accepted import AcceptedCommands
from space_robot_sim.nodes.turns import Turns

# After a stall all wrenches may come before the first effort.
JOIN_CAPACITY = 1024
# Marks that are looked up in the graph; more are no marks.
MAX_SENDERS = 64
# Counted, but nothing that was refused or is missing.
REPEATED = "repeated"
# How long a controller that answered with what cannot be used is given to answer again; of the steady clock.
SECOND_CHANCE = 1.0

Joiner = StampJoiner[tuple[bytes, Sequence[bytes]]]


class CommandPort:
    """Takes the parts of commands from the graph and offers at most one valid answer to the awaited stamp.

    The first valid answer to a state counts, whichever node sent it. Its parts carry one mark, or both none, see
    ``SenderMark``: parts of two shipped controllers, or of one and of another node, never make one command.
    A message with a stale or future stamp, with wrong names, wrong size or a number that is not finite is counted and
    is no answer. Where only such a message answers a state in lock-step, the plant holds, ``SECOND_CHANCE`` later.

    Args:
        node: the node to subscribe on.
        joint_names: names a joint command must carry, in this order.
        on_answer: called when the awaited stamp has its answer.
        keep_late: for so many periods an answer that is late may still be run where nothing newer is there (paced
            runs); 0: none is.
        period: control period [ns].
        turns: of a run with two controllers, of which the one whose turn it is not answers nothing; None: there is one.
    """

    def __init__(
        self,
        node: GraphNode,
        joint_names: tuple[str, ...],
        on_answer: Callable[[], None],
        *,
        period: int,
        keep_late: int = 0,
        turns: Turns | None = None,
    ) -> None:
        self._node, self._on_answer = node, on_answer
        self._period, self._keep_late = period, keep_late * period
        self._codec = CommandCodec(joint_names)
        self._marks = SenderMark(self._codec.layouts)
        # By the mark of the sender; what has none of a publisher of commands is joined among itself.
        self._joiners: dict[bytes, Joiner] = {}
        self._senders: dict[bytes, str] = {}
        self._second_chance = node.create_timer(
            SECOND_CHANCE, self._hold, clock=Clock(clock_type=ClockType.STEADY_TIME), autostart=False
        )
        self.counts: Counter[str] = Counter()
        self._turns = turns
        self.accepted = AcceptedCommands(node, always=keep_late > 0, turns=turns)
        self.restart()
        self.readers = [self._listen_part(index, topic) for index, topic in enumerate(self._codec.topics)]

    def restart(self) -> None:
        """Await the answer to state 0 of a new run; all that was heard before is forgotten."""
        self._joiners.clear()
        self.accepted.clear()
        self._newest: Command | None = None
        self._await(0)

    def expect(self, stamp: int) -> None:
        """Await the answer to the state with this stamp [ns], the one after the state before."""
        self._await(stamp)

    def take(self) -> Command | None:
        """The answer to the awaited stamp; None where it could not be used."""
        return self._answer

    def take_newest(self) -> Command | None:
        """The newest valid command not applied yet, counting what is missing; None where there is none."""
        if self.answered:
            return self._answer
        self.counts["missed"] += 1
        self.accepted.pass_by(self._awaited)
        late, self._newest = self._newest, None
        return late

    def _await(self, stamp: int) -> None:
        self._awaited = stamp
        self._answer: Command | None = None
        self.answered = self._invalid = False

    def _listen_part(self, index: int, topic: Topic) -> Subscription:
        def on_part(raw: bytes) -> None:
            mark, raw = self._marks.read(index, raw), self._marks.remove(index, raw)
            try:
                stamp = self._codec.peek(index, raw)
            except SpaceRobotError as error:
                self._refuse("malformed", topic, error, mark)
                return
            if not self._in_time(stamp, topic, raw, mark):
                return
            try:
                blocks = self._codec.finite_blocks(index, raw)
            except SpaceRobotError as error:
                self._refuse("invalid", topic, error, mark)
                self._wait_for_a_valid_one(stamp)
                return
            joined = self._joiner(mark).add(index, stamp, (raw, blocks))
            if joined is not None:
                self._take_in(stamp, joined, mark)

        return self._node.listen(topic, on_part)

    def _joiner(self, mark: bytes) -> Joiner:
        """Where the parts of one sender meet, so that two senders never make one command."""
        joiner = self._joiners.get(mark)
        if joiner is None:
            # Of a message without a mark the two bytes may be anything, and different ones are no different senders.
            mark = mark if self._sender(mark) else UNMARKED
            joiner = self._joiners.get(mark)
            if joiner is None:
                joiner = StampJoiner(len(self._codec.topics), JOIN_CAPACITY, once=False)
            self._joiners[mark] = joiner
        return joiner

    def _sender(self, mark: bytes) -> str:
        """Full name of the node with this mark; nothing: there is none."""
        if mark not in self._senders and mark != UNMARKED and len(self._senders) < MAX_SENDERS:
            found = self._node.publishers_by_mark(self._codec.topics[0]).get(mark, "")
            if self._turns is not None and found.rpartition("/")[2] not in CONTROLLERS:
                # A node is discovered before its name, and by its name it is one of two controllers.
                return found
            self._senders[mark] = found
        return self._senders.get(mark, "")

    def _in_time(self, stamp: int, topic: Topic, raw: bytes, mark: bytes) -> bool:
        if self._turns is not None and (why := self._turns.refusal(self._sender(mark), stamp)):
            self._refuse("out of turn", topic, why, mark)
            return False
        if stamp == self._awaited and not self.answered:
            return True
        if stamp > self._awaited:
            self._refuse("future", topic, f"stamp {stamp} ns is ahead of the state at {self._awaited} ns", mark)
            return False
        known = self.accepted.parts(stamp)
        # What is delivered twice, or answered twice alike, is counted without a word: nothing is lost with it.
        if known is not None and raw in known:
            self.counts[REPEATED] += 1
            return False
        self.counts["late"] += 1
        if self._keep_late and known is None and stamp >= 0 and stamp % self._period == 0:
            return True
        what = "older than" if stamp < self._awaited else "another answer to"
        why = f"stamp {stamp} ns is {what} the state at {self._awaited} ns"
        self._refuse("stale", topic, why, mark)
        return False

    def _take_in(self, stamp: int, parts: Sequence[tuple[bytes, Sequence[bytes]]], mark: bytes) -> None:
        command = self._codec.join(stamp, [blocks for _, blocks in parts])
        if stamp == self._awaited and self.answered:
            return
        raws = tuple([raw for raw, _ in parts])
        if self._awaited - stamp > self._keep_late:
            self.accepted.add_too_late(command, raws, self._awaited)
            why = f"stamp {stamp} ns is too old for the state at {self._awaited} ns"
            self._refuse("stale", self._codec.topics[0], why, mark)
            return
        self.accepted.add(command, raws)
        if stamp == self._awaited:
            self._answer, self.answered = command, True
            self._on_answer()
        elif self._newest is None or stamp > self._newest.stamp:
            self._newest = command

    def _wait_for_a_valid_one(self, stamp: int) -> None:
        if stamp == self._awaited and not self.answered and not self._keep_late:
            self._invalid = True
            self._second_chance.reset()

    def _hold(self) -> None:
        """Nothing but an unusable answer came to the state at which the run stands, and no other node can answer."""
        self._second_chance.cancel()
        alone = all(reader.get_publisher_count() <= 1 for reader in self.readers)
        if alone and self._invalid and not self.answered:
            self.answered = True
            self.accepted.add_none(self._awaited)
            try:
                self._on_answer()
            except Exception as error:
                self._node.fail(error)

    def _refuse(self, what: str, topic: Topic, why: object, mark: bytes) -> None:
        self.counts[what] += 1
        if said := self._node.reasons.add(topic.name, f"{what}: {why}"):
            sender = self._sender(mark)
            others = () if sender else self._senders.values()
            senders = f"published by {sender}" if sender else self._node.senders(topic, others)
            self._node.get_logger().warning(f"refused a message on {topic.name} as {said}; {senders}")
