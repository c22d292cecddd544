"""The messages of ticks that are not in the log yet: which of several counts, and when a tick has all of them."""

from __future__ import annotations

from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.topics import BASE_ODOM, CONTROLLER_TELEMETRY, PLANT_TELEMETRY, Topic, topics_of

# Paced, answers to states that are so many ticks older do not act, and so much later a recorder waits for none.
MAX_LATE = 50
# References of a run that begins again are kept for so many ticks before this is heard.
EARLY = 64
COMMANDS = frozenset(topics_of("command"))
SAMPLE = frozenset((*topics_of("state"), *topics_of("plant_telemetry")))
ANSWERS = frozenset(
    ("supervision_event", "housekeeping", "supervision", "command", "controller_telemetry", "controller_event")
)

Parts = dict[Topic, bytes]


class TickParts:
    """Collects the messages of each stamp of a run.

    One message that should not be there is distinguished from the others by its time, not by its sender. Before the
    plant has reached a stamp, which is when its state and telemetry are complete, the newest message of a topic
    counts, for a stranger's came before its time; afterwards the first. References are sent ahead, and their first
    counts.

    Args:
        period: control period [ns].
        steps: number of periods of the run.
        paced: not every stamp has an answer.

    Attributes:
        next: stamp of the tick that is to be written next [ns].
        reached: stamp of the newest state [ns]; -1: none.
        expected: topics that a complete tick has.
        sample: topics by which the plant shows that it has reached a stamp.
        contested: more than one node commands, or the run is paced: commands of the graph do not count, but what the
            simulator accepted.
        decided: paced, stamp of the newest period of which the simulator said what it did with its command [ns]; what
            it accepted before is known, for it says so in order.
    """

    def __init__(self, period: int, steps: int, *, paced: bool = False) -> None:
        self._period, self._last, self._paced = period, steps * period, paced
        self.expected = {topic for topic in LOGGED if not (topic.sporadic or topic.optional)}
        self.sample = SAMPLE
        self.contested, self._again = paced, False
        self._early: dict[int, Parts] = {}
        self._pending: dict[int, Parts] = {}
        # What gives way to the next message of its topic and stamp.
        self._provisional: set[tuple[Topic, int]] = set()
        # Topics that were waited for long enough; one that comes after all is waited for again.
        self._given_up: set[Topic] = set()
        self._restart()

    def _restart(self) -> None:
        self.next, self.reached, self._doubted, self.decided = 0, -1, -1, -1
        # Stamps of ticks without a command, for which the plant holds.
        self._held: set[int] = set()
        # The tick that was given out last: a state is said again where it waits.
        self._popped: tuple[int, Parts] = -1, {}
        self._newest: dict[Topic, int] = {}

    def begin_again(self) -> None:
        """A new run; of the one before only references are kept, which are functions of time and may be sent early."""
        kept = {
            stamp: {topic: data for topic, data in parts.items() if topic.kind == "reference"}
            for stamp, parts in self._pending.items()
        }
        for stamp, parts in self._early.items():
            kept.setdefault(stamp, {}).update(parts)
        self._provisional = {(topic, stamp) for stamp, parts in kept.items() for topic in parts}
        self._pending, self._early, self._again = kept, {}, True
        self._restart()

    def take(self, topic: Topic, stamp: int, data: bytes) -> str | None:
        """Take a message.

        Returns:
            Why it is refused; empty: it is taken, and the next tick may be complete now; None: it is taken.
        """
        if self._paced or self._given_up:
            self._follow(topic, stamp)
        parts = self._pending.get(stamp)
        if parts is None:
            if stamp % self._period or not 0 <= stamp <= self._last:
                return f"stamp {stamp} ns is not a tick of this run"
            if stamp < self.next:
                return self._take_old(topic, stamp, data)
            parts = self._pending[stamp] = {}
        elif topic in parts and self._stays(topic, stamp):
            return None if parts[topic] == data else f"stamp {stamp} ns has another one"
        parts[topic] = data
        if stamp == 0 and topic.kind == "reference":
            # Guidance begins again: what it said before for later stamps is of the run before.
            self._provisional.update((topic, other) for other, its in self._pending.items() if other and topic in its)
        if stamp > self.reached and topic.kind != "reference":
            if self._is_early(topic, stamp, parts):
                self._provisional.add((topic, stamp))
            # That which comes last is asked for first.
            if PLANT_TELEMETRY in parts and topic in self.sample and parts.keys() >= self.sample:
                self._reach(stamp)
                return ""
        return "" if len(parts) >= len(self.expected) or self._held else None

    def hold(self, stamp: int) -> None:
        """The tick of this stamp [ns] has no command."""
        self._held.add(stamp)

    def decide(self, stamp: int) -> None:
        """The simulator has said what it did with the command of the period that begins at this stamp [ns]."""
        if stamp <= self._last:
            self.decided = max(self.decided, stamp)

    def contest(self) -> None:
        """From now on only commands that the simulator accepted are given to ``take``."""
        self.contested = True
        for parts in self._pending.values():
            for topic in COMMANDS:
                parts.pop(topic, None)

    def complete(self) -> bool:
        """Whether the next tick has all it is expected to have."""
        parts = self._pending.get(self.next)
        return parts is not None and parts.keys() >= (
            self.expected - COMMANDS if self.next in self._held else self.expected
        )

    def lacks(self) -> set[Topic]:
        """What the next tick lacks where the plant has reached it."""
        return self.expected - self._pending.get(self.next, {}).keys() if self.reached >= self.next else set()

    def missing(self) -> set[Topic]:
        """Paced: what the next tick lacks and may still get, everything where the plant is not there yet.

        The messages of a topic come in the order of their stamps, so what has one for a later tick has none for this.
        The telemetry of a controller comes with an answer, and the answer as long as it may act.
        """
        return self._missing(self.next) if self.reached >= self.next else set(self.expected)

    def awaited(self) -> set[Topic]:
        """Paced: what any tick lacks that the plant reached, or everything where it has reached none that is left."""
        stamps = range(self.next, self.reached + 1, self._period)
        return set().union(*map(self._missing, stamps)) if stamps or self.next > self._last else self.missing()

    def _missing(self, stamp: int) -> set[Topic]:
        parts = self._pending.get(stamp, {})
        lacks = {topic for topic in self.expected - parts.keys() if self._newest.get(topic, -1) <= stamp}
        if not parts.keys() >= COMMANDS:
            lacks.discard(CONTROLLER_TELEMETRY)
        # Of commands the simulator says it, or time.
        horizon = stamp + MAX_LATE * self._period
        may_come = self.decided <= horizon if self.contested else self.reached < horizon
        return (lacks - COMMANDS) | (self.expected & COMMANDS - parts.keys() if may_come else set())

    def pop(self) -> tuple[int, Parts]:
        """Stamp [ns] and messages of the next tick, which is then the one after it."""
        stamp = self.next
        parts = self._pending.pop(stamp, {})
        self.next += self._period
        self._held.discard(stamp)
        self._popped = stamp, parts
        if self._provisional:
            self._provisional.difference_update((topic, stamp) for topic in parts)
        return stamp, parts

    def give_up(self, topics: set[Topic]) -> None:
        """Wait no more for topics, until one of their messages comes."""
        self.expected -= topics
        self._given_up |= topics

    def rest(self) -> list[tuple[int, Parts]]:
        """What there is of ticks that the plant reached and that are not written, in order; the run is over."""
        stamps = sorted(stamp for stamp in self._pending if self.next <= stamp <= self.reached)
        self.next = stamps[-1] + self._period if stamps else self.next
        # Copies: of the references some are for a run that begins again.
        return [(stamp, dict(self._pending[stamp])) for stamp in stamps]

    def _take_old(self, topic: Topic, stamp: int, data: bytes) -> str | None:
        if topic in self.sample:
            if stamp == self._popped[0] and data == self._popped[1].get(topic):
                return None
            return f"stamp {stamp} ns is recorded already, and the run was not reset"
        if topic.kind == "reference" and stamp < EARLY * self._period:
            self._early.setdefault(stamp, {})[topic] = data
        return None

    def _follow(self, topic: Topic, stamp: int) -> None:
        if topic in self._given_up:
            self._given_up.discard(topic)
            self.expected.add(topic)
        if stamp <= self._last:
            self._newest[topic] = max(stamp, self._newest.get(topic, -1))

    def _is_early(self, topic: Topic, stamp: int, parts: Parts) -> bool:
        """Whether a message is there before that of the run should be; topics have no order, so it may be that one."""
        if topic is PLANT_TELEMETRY and BASE_ODOM not in parts:
            return True
        return topic not in self.sample or stamp > self.reached + self._period

    def _stays(self, topic: Topic, stamp: int) -> bool:
        """Whether the first of two messages counts; of commands the simulator knows which one does."""
        if (topic, stamp) in self._provisional:
            self._provisional.discard((topic, stamp))
            return False
        return topic not in COMMANDS and (stamp <= self.reached or topic.kind == "reference")

    def _reach(self, stamp: int) -> None:
        """The plant is at this state; one that does not follow the newest is believed when the next one follows it."""
        if self._again:
            # Answers of the run before that came after its end.
            self._again = False
            self._held.clear()
            self.decided = -1
            for other in [other for other in self._pending if other > stamp]:
                parts = self._pending[other]
                self._pending[other] = {topic: data for topic, data in parts.items() if topic.kind not in ANSWERS}
        if stamp in (0, self.reached + self._period, self._doubted + self._period):
            self.reached = stamp
        else:
            self._doubted = stamp
