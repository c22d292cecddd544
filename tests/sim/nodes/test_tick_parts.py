"""What a recorder keeps of the messages it hears, without ROS."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.topics import (
    BASE_ODOM,
    CONTROLLER_TELEMETRY,
    JOINT_COMMAND,
    REFERENCE_BASE,
    Topic,
)
from space_robot_sim.nodes.tick_parts import COMMANDS, MAX_LATE, TickParts

PERIOD, STEPS = 10, 6
# In the order in which the nodes of a run send them.
ORDER = ("reference", "state", "plant_telemetry", "controller_telemetry", "command")
TOPICS = sorted(
    (topic for topic in LOGGED if not (topic.sporadic or topic.optional)), key=lambda topic: ORDER.index(topic.kind)
)
RUN = [(topic, tick * PERIOD) for tick in range(STEPS + 1) for topic in TOPICS]
quick = settings(deadline=None, max_examples=60)


def data(topic: Topic, stamp: int, sender: str = "run") -> bytes:
    return f"{sender} {topic.name} {stamp}".encode()


Tick = tuple[int, dict[Topic, bytes]]


def feed(parts: TickParts, messages: list[tuple[Topic, int]], sender: str = "run") -> list[Tick]:
    """Take messages; the ticks that are complete meanwhile."""
    found = []
    for topic, stamp in messages:
        if parts.take(topic, stamp, data(topic, stamp, sender)) == "":
            while parts.complete():
                found.append(parts.pop())
    return found


def whole(ticks: range) -> list[Tick]:
    return [(k * PERIOD, {topic: data(topic, k * PERIOD) for topic in TOPICS}) for k in ticks]


@quick
@given(order=st.permutations(RUN))
def test_the_order_of_arrival_changes_nothing(order: list[tuple[Topic, int]]) -> None:
    """However the messages of a run are mixed, its ticks come out whole and in order."""
    assert feed(TickParts(PERIOD, STEPS), order) == whole(range(STEPS + 1))


@quick
@given(
    topic=st.sampled_from([topic for topic in TOPICS if topic.kind not in ("reference", "command")]),
    now=st.integers(0, STEPS - 1),
    ahead=st.integers(1, STEPS),
)
def test_a_message_before_its_time_is_replaced_by_that_of_the_run(topic: Topic, now: int, ahead: int) -> None:
    """What a stranger says for a tick to come is not in that tick."""
    parts, stamp = TickParts(PERIOD, STEPS), min(now + ahead, STEPS) * PERIOD
    found = feed(parts, [message for message in RUN if message[1] <= now * PERIOD])
    feed(parts, [(topic, stamp)], "stranger")
    found += feed(parts, [message for message in RUN if message[1] > now * PERIOD])
    assert found == whole(range(STEPS + 1))


def test_after_its_time_the_first_message_stays_and_the_other_is_refused() -> None:
    """A state that is there, a reference, and a tick in the log are not replaced; the same again is no matter."""
    parts = TickParts(PERIOD, STEPS)
    feed(parts, [message for message in RUN if message[1] == 0])
    feed(parts, [message for message in RUN if message[1] == PERIOD and message[0] not in COMMANDS])
    assert "recorded already" in str(parts.take(BASE_ODOM, 0, b"x"))
    assert "has another one" in str(parts.take(BASE_ODOM, PERIOD, b"x"))
    assert "has another one" in str(parts.take(CONTROLLER_TELEMETRY, PERIOD, b"x"))
    assert parts.take(BASE_ODOM, PERIOD, data(BASE_ODOM, PERIOD)) is None
    assert parts.take(REFERENCE_BASE, 2 * PERIOD, b"first") is None
    assert "has another one" in str(parts.take(REFERENCE_BASE, 2 * PERIOD, b"second"))
    for stamp in (-PERIOD, PERIOD + 1, (STEPS + 1) * PERIOD):
        assert "not a tick of this run" in str(parts.take(BASE_ODOM, stamp, b"x"))


def test_a_state_that_does_not_follow_moves_no_window() -> None:
    """In a paced run a single sample far ahead ends no tick; two in a row, after states were lost, do."""
    samples = [topic for topic in TOPICS if topic.kind in ("state", "plant_telemetry")]
    parts = TickParts(PERIOD, 1000, paced=True)
    parts.contested = False
    for tick in (0, 500):
        feed(parts, [(topic, tick * PERIOD) for topic in samples])
    assert parts.missing() >= COMMANDS
    feed(parts, [(topic, 501 * PERIOD) for topic in samples])
    assert not parts.missing() & COMMANDS
    assert parts.reached > MAX_LATE * PERIOD


@quick
@given(reached=st.integers(1, STEPS), early=st.integers(0, STEPS), late=st.sampled_from(TOPICS))
def test_a_run_that_begins_again_is_whole(reached: int, early: int, late: Topic) -> None:
    """References sent before the reset is heard are kept, and an answer of the old run that comes late is not."""
    parts = TickParts(PERIOD, STEPS)
    references = [message for message in RUN if message[0].kind == "reference"]
    feed(parts, references)
    feed(parts, [message for message in RUN if message[1] < reached * PERIOD and message not in references])
    ahead = [message for message in references if message[1] <= early * PERIOD]
    feed(parts, ahead)
    assert all(stamp <= parts.reached for stamp, _ in parts.rest())
    parts.begin_again()
    if late.kind in ("command", "controller_telemetry"):
        feed(parts, [(late, reached * PERIOD)], "old")
    rest = [message for message in RUN if message not in ahead]
    assert feed(parts, rest) == whole(range(STEPS + 1))


def test_contested_commands_are_those_that_are_given_afterwards() -> None:
    """What the graph said before is dropped, and a tick for which the plant holds needs no command."""
    parts = TickParts(PERIOD, STEPS)
    first = [message for message in RUN if message[1] == 0]
    feed(parts, first[:-1])
    parts.contest()
    assert not parts.complete()
    ((_, written),) = feed(parts, [message for message in first if message[0] in COMMANDS], "accepted")
    assert written[JOINT_COMMAND] == data(JOINT_COMMAND, 0, "accepted")
    feed(parts, [message for message in RUN if message[1] == PERIOD and message[0] not in COMMANDS])
    assert not parts.complete()
    parts.hold(PERIOD)
    assert parts.complete()
    assert not COMMANDS & parts.pop()[1].keys()


def paced(ticks: int = 1000) -> TickParts:
    """Of a paced run: commands count as the simulator accepted them."""
    parts = TickParts(PERIOD, ticks, paced=True)
    feed(parts, [(topic, tick * PERIOD) for topic in TOPICS if topic.kind == "reference" for tick in range(200)])
    return parts


def reach(parts: TickParts, ticks: range, *, decide: bool = True) -> None:
    """States without answers; the simulator says of each that its period is over."""
    for tick in ticks:
        feed(parts, [(topic, tick * PERIOD) for topic in TOPICS if topic.kind in ("state", "plant_telemetry")])
        if decide:
            parts.decide(tick * PERIOD)


def test_a_paced_tick_waits_until_its_command_can_come_no_more() -> None:
    """However far the plant is, the simulator has to have said that it accepts no answer to that state."""
    parts = paced()
    reach(parts, range(MAX_LATE + 20), decide=False)
    assert parts.missing() == COMMANDS
    parts.decide(MAX_LATE * PERIOD)
    assert parts.missing() == COMMANDS
    parts.decide((MAX_LATE + 1) * PERIOD)
    assert not parts.missing()


def test_a_late_command_is_in_the_tick_of_its_state() -> None:
    """It waits with its tick for its telemetry, however late; a tick without a command waits for none."""
    parts = paced()
    reach(parts, range(MAX_LATE + 1))
    feed(parts, [(topic, 0) for topic in COMMANDS])
    reach(parts, range(MAX_LATE + 1, 3 * MAX_LATE))
    assert parts.missing() == {CONTROLLER_TELEMETRY}
    feed(parts, [(CONTROLLER_TELEMETRY, 0)])
    # Complete, it was taken out.
    assert parts.next == PERIOD
    assert not parts.missing()


def test_a_topic_with_a_later_message_has_none_for_this_tick() -> None:
    """What comes in order and is ahead of a tick has left it out; what is behind may be under way."""
    parts = paced()
    reach(parts, range(2))
    feed(parts, [(topic, tick * PERIOD) for topic in COMMANDS for tick in range(2)])
    assert parts.missing() == {CONTROLLER_TELEMETRY}
    feed(parts, [(CONTROLLER_TELEMETRY, PERIOD)])
    assert not parts.missing()


def test_what_is_given_up_is_waited_for_again_when_it_comes() -> None:
    """A controller without telemetry delays the log once; one that has some later is waited for."""
    parts = paced()
    reach(parts, range(3))
    feed(parts, [(topic, tick * PERIOD) for topic in COMMANDS for tick in range(3)])
    parts.give_up(parts.missing())
    assert not parts.missing()
    assert parts.expected >= COMMANDS
    parts.pop()
    feed(parts, [(CONTROLLER_TELEMETRY, PERIOD)])
    assert CONTROLLER_TELEMETRY in parts.expected


def test_a_stamp_beyond_the_run_decides_nothing() -> None:
    """What no simulator says of this run must not end the wait."""
    parts = paced(100)
    parts.decide(101 * PERIOD)
    assert parts.decided == -1


def test_references_of_a_run_before_give_way_where_guidance_begins_again() -> None:
    """One that comes after the reset, for a later stamp, is of the run before: what follows stamp 0 counts."""
    parts = TickParts(PERIOD, STEPS)
    parts.begin_again()
    assert parts.take(REFERENCE_BASE, PERIOD, b"old") is None
    assert parts.take(REFERENCE_BASE, 0, b"new") is None
    assert parts.take(REFERENCE_BASE, PERIOD, b"new") is None
    assert "has another one" in str(parts.take(REFERENCE_BASE, PERIOD, b"a stranger's"))
