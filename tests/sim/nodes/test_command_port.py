"""What a simulator takes for the answer to a state, without a graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.codec.codecs import AcceptedCodec, CommandCodec
from space_robot_msgs_py.codec.sender_mark import UNMARKED, SenderMark
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.nodes.command_port import JOIN_CAPACITY, MAX_SENDERS, CommandPort
from space_robot_sim.nodes.turns import Turns

pytestmark = pytest.mark.ros
PERIOD = 100
NAMES = ("shoulder", "elbow")
CODEC = CommandCodec(NAMES)
WRENCH, JOINTS = range(2)
OURS, THEIRS, STRANGE = b"\x01\x00", b"\x02\x00", b"\x03\x00"


class Graph:
    """A node on a graph in which the test says who publishes, when time is over, and what is said.

    Attributes:
        port: of the simulator.
        answers: how often it was called for an answer.
        warnings: what was logged.
        accepted: what was published of commands.
        failures: what ended the run.
        waiting: the timer runs; None: it was never set.
    """

    def __init__(self, *, paced: int = 0, turns: Turns | None = None, senders: dict[bytes, str] | None = None) -> None:
        self.answers, self.looks, self.publishers = 0, 0, [1, 1]
        self.warnings: list[str] = []
        self.accepted: list[Any] = []
        self.failures: list[Exception] = []
        self.waiting: bool | None = None
        self.known = {OURS: "/controller", THEIRS: "/stranger"} if senders is None else senders
        self._heard: dict[str, Callable[[bytes], None]] = {}
        self.on_answer: Callable[[], None] = self._count
        self.port = CommandPort(
            self._node(), NAMES, lambda: self.on_answer(), period=PERIOD, keep_late=paced, turns=turns
        )

    def _count(self) -> None:
        self.answers += 1

    def _node(self) -> Any:
        said = SimpleNamespace(
            publish=lambda raw: self.accepted.append(AcceptedCodec().decode(raw)),
            handle=SimpleNamespace(get_subscription_count=lambda: 0),
        )
        return SimpleNamespace(
            create_timer=self._timer,
            listen=self._listen,
            publisher=lambda topic: said,
            publishers_by_mark=self._look,
            reasons=SimpleNamespace(add=lambda topic, why: why),
            senders=lambda topic, others: f"published by one that is not {sorted(others)}",
            get_logger=lambda: SimpleNamespace(warning=self.warnings.append),
            fail=self.failures.append,
        )

    def _timer(self, seconds: float, over: Callable[[], None], *, clock: Any, autostart: bool) -> Any:
        assert (seconds, autostart) == (1.0, False)
        self.time_is_over = over

        def wait(value: bool) -> None:
            self.waiting = value

        return SimpleNamespace(reset=lambda: wait(True), cancel=lambda: wait(False))

    def _listen(self, topic: Any, callback: Callable[[bytes], None]) -> Any:
        index = len(self._heard)
        self._heard[topic.name] = callback
        return SimpleNamespace(get_publisher_count=lambda: self.publishers[index])

    def take_in(self, index: int, raw: bytes) -> None:
        """One part of a command comes."""
        self._heard[CODEC.topics[index].name](raw)

    def _look(self, topic: Any) -> dict[bytes, str]:
        self.looks += 1
        return dict(self.known)

    def hear(self, stamp: int, effort: float = 0.5, mark: bytes = UNMARKED, only: Sequence[int] = (0, 1)) -> None:
        """The parts of a command come."""
        command = Command(stamp, np.full(6, 0.25), [0.5, 0.5])
        parts = SenderMark(CODEC.layouts).put(CODEC.encode(command), mark)
        for index in only:
            raw = parts[index].replace(np.float64(0.5).tobytes(), np.float64(effort).tobytes())
            self.take_in(index, raw)

    @property
    def effort(self) -> float | None:
        """Of the answer."""
        command = self.port.take()
        return None if command is None else float(command.effort[0])


def effort_of(command: Command | None) -> float | None:
    return None if command is None else float(command.effort[0])


def test_the_first_valid_answer_to_the_state_that_waits_counts() -> None:
    """The plant is called once; the same again is counted as repeated, another one is late, and neither acts."""
    graph = Graph()
    graph.hear(0, 1.0, only=[WRENCH])
    assert (graph.answers, graph.port.answered, graph.port.take()) == (0, False, None)
    graph.hear(0, 1.0, only=[JOINTS])
    assert (graph.answers, graph.port.answered, graph.effort) == (1, True, 1.0)
    graph.hear(0, 1.0)
    assert graph.port.counts == {"repeated": 2}
    graph.hear(0, 2.0)
    assert graph.port.counts == {"repeated": 3, "late": 1, "stale": 1}
    assert (graph.answers, graph.effort) == (1, 1.0)
    (said,) = graph.warnings
    assert "stale: stamp 0 ns is another answer to the state at 0 ns" in said
    graph.port.expect(PERIOD)
    assert (graph.port.answered, graph.port.take()) == (False, None)


def test_answers_to_other_states_are_refused_in_lock_step() -> None:
    """Before it and after it, each with its reason; no half of one is joined with a half of the right one."""
    graph = Graph()
    graph.port.expect(PERIOD)
    graph.hear(0, 2.0, only=[WRENCH])
    graph.hear(2 * PERIOD, 2.0)
    assert graph.port.counts == {"late": 1, "stale": 1, "future": 2}
    stale, future, _ = graph.warnings
    assert "stale: stamp 0 ns is older than the state at 100 ns" in stale
    assert "future: stamp 200 ns is ahead of the state at 100 ns" in future
    assert list(graph.port.accepted.kept) == []
    graph.hear(PERIOD, 1.0)
    assert (graph.answers, graph.effort) == (1, 1.0)


def test_what_is_no_message_is_malformed() -> None:
    """Nothing waits for another answer because of it."""
    graph = Graph()
    graph.take_in(WRENCH, b"\0")
    assert graph.port.counts == {"malformed": 1}
    assert (graph.waiting, graph.answers) == (None, 0)


def test_the_plant_holds_where_only_an_unusable_answer_comes() -> None:
    """A second later, once, and no longer than till the next state."""
    graph = Graph()
    graph.hear(0, float("nan"), only=[JOINTS])
    assert graph.port.counts == {"invalid": 1}
    assert (graph.waiting, graph.port.answered) == (True, False)
    graph.time_is_over()
    assert (graph.waiting, graph.port.answered, graph.port.take(), graph.answers) == (False, True, None, 1)
    assert list(graph.port.accepted.kept) == [0]
    graph.time_is_over()
    assert graph.answers == 1
    graph.port.expect(PERIOD)
    graph.time_is_over()
    assert (graph.port.answered, graph.answers) == (False, 1)


def test_an_answer_that_can_be_used_comes_before_the_hold() -> None:
    """One that comes within the second acts, and time is over for nothing."""
    graph = Graph()
    graph.hear(0, float("nan"), only=[JOINTS])
    graph.hear(0, 1.0)
    graph.time_is_over()
    assert (graph.answers, graph.effort) == (1, 1.0)
    graph.waiting = None
    graph.hear(0, float("nan"), only=[JOINTS])
    assert graph.waiting is None


@pytest.mark.parametrize(("publishers", "holds"), [((0, 0), True), ((1, 1), True), ((2, 1), False), ((1, 2), False)])
def test_the_plant_waits_while_another_node_may_answer(publishers: tuple[int, int], holds: bool) -> None:
    """It holds only where one node publishes commands at the most."""
    graph = Graph()
    graph.publishers = list(publishers)
    graph.hear(0, float("nan"), only=[JOINTS])
    graph.time_is_over()
    assert graph.port.answered is holds


def test_an_unusable_answer_to_another_state_is_no_reason_to_hold() -> None:
    """In lock-step it is refused by its stamp; in a paced run the clock goes on anyway."""
    graph = Graph()
    graph.port.expect(PERIOD)
    graph.hear(0, float("nan"), only=[JOINTS])
    assert (graph.waiting, graph.port.counts["invalid"]) == (None, 0)
    paced = Graph(paced=2)
    paced.hear(0, float("nan"), only=[JOINTS])
    assert (paced.waiting, paced.port.counts["invalid"]) == (None, 1)
    paced.time_is_over()
    assert not paced.port.answered


def test_what_fails_in_a_hold_ends_the_run() -> None:
    """An error behind the timer is the node's."""
    graph, error = Graph(), ValueError("x")

    def fail() -> None:
        raise error

    graph.on_answer = fail
    graph.hear(0, float("nan"), only=[JOINTS])
    graph.time_is_over()
    assert graph.failures == [error]


def test_halves_of_two_nodes_make_no_command() -> None:
    """Those of one node do, and so do those of nodes that the graph does not know, whatever stands for their mark."""
    graph = Graph()
    graph.hear(0, 1.0, OURS, only=[WRENCH])
    graph.hear(0, 2.0, THEIRS, only=[JOINTS])
    assert not graph.port.answered
    graph.hear(0, 3.0, THEIRS, only=[WRENCH])
    assert graph.effort == 2.0
    unknown = Graph()
    unknown.hear(0, 4.0, STRANGE, only=[WRENCH])
    unknown.hear(0, 4.0, only=[JOINTS])
    assert unknown.effort == 4.0


def test_the_graph_is_asked_once_for_each_mark_and_for_so_many() -> None:
    """What more marks there are is taken for none, and the one that sent a message is named where it is known."""
    marks = [k.to_bytes(2, "little") for k in range(1, MAX_SENDERS + 2)]
    graph = Graph(senders={mark: f"/node{k}" for k, mark in enumerate(marks)})
    for _ in range(2):
        for mark in marks:
            graph.hear(PERIOD, 1.0, mark, only=[JOINTS])
    assert graph.looks == MAX_SENDERS
    assert graph.warnings[0].endswith("published by /node0")
    assert "/node64" not in graph.warnings[MAX_SENDERS]
    assert "published by one that is not ['/node0', " in graph.warnings[MAX_SENDERS]
    # It has no mark then, and its halves are joined with those of others that have none.
    graph.hear(0, 1.0, marks[-1], only=[WRENCH])
    graph.hear(0, 1.0, UNMARKED, only=[JOINTS])
    assert graph.effort == 1.0


def test_the_halves_that_wait_are_bounded() -> None:
    """After a stall all wrenches of so many periods may come before the first effort, in a paced run."""
    graph = Graph(paced=JOIN_CAPACITY)
    graph.port.expect(JOIN_CAPACITY * PERIOD)
    for tick in range(JOIN_CAPACITY + 1):
        graph.hear(tick * PERIOD, 1.0, only=[WRENCH])
    graph.hear(PERIOD, 2.0, only=[JOINTS])
    assert effort_of(graph.port.take_newest()) == 2.0
    graph.hear(0, 1.0, only=[JOINTS])
    assert graph.port.take_newest() is None


def test_of_late_answers_the_newest_acts_once() -> None:
    """Paced: where nothing newer is there, not again, and not one that is older than it."""
    graph = Graph(paced=3)
    assert graph.port.take_newest() is None
    graph.port.expect(2 * PERIOD)
    graph.hear(PERIOD, 2.0)
    graph.hear(0, 1.0)
    assert (graph.answers, graph.port.answered) == (0, False)
    assert graph.port.counts == {"missed": 1, "late": 4}
    assert effort_of(graph.port.take_newest()) == 2.0
    assert graph.port.take_newest() is None
    assert graph.port.counts["missed"] == 3
    graph.port.expect(3 * PERIOD)
    graph.hear(3 * PERIOD, 3.0)
    assert effort_of(graph.port.take_newest()) == 3.0
    assert (graph.port.counts["missed"], graph.answers) == (3, 1)
    assert graph.warnings == []
    # Every period that was over without its command is published.
    assert [one.stamp for one in graph.accepted if one.command is None] == [0, 200, 200]


def test_a_late_answer_acts_up_to_its_bound() -> None:
    """At so many periods it does, later it is refused and recorded as too late; what is no tick has no answer."""
    graph = Graph(paced=3)
    graph.port.expect(4 * PERIOD)
    graph.hear(PERIOD + 1, 1.0, only=[WRENCH])
    assert graph.port.counts == {"late": 1, "stale": 1}
    graph.hear(0, 1.0)
    assert graph.port.counts == {"late": 3, "stale": 2}
    assert "stale: stamp 0 ns is too old for the state at 400 ns" in graph.warnings[-1]
    assert [(one.stamp, one.too_late) for one in graph.accepted] == [(0, True)]
    assert graph.port.take_newest() is None
    graph.hear(PERIOD, 2.0)
    assert effort_of(graph.port.take_newest()) == 2.0
    # Its state has its answer now.
    graph.hear(PERIOD, 3.0)
    assert graph.port.take_newest() is None
    assert graph.port.counts["stale"] == 3


def test_a_half_that_comes_when_the_state_is_answered_makes_no_second_answer() -> None:
    """Paced: two halves of another node, of which the first came in time, change nothing."""
    graph = Graph(paced=3)
    graph.hear(0, 1.0, THEIRS, only=[JOINTS])
    graph.hear(0, 2.0, OURS)
    graph.hear(0, 1.0, THEIRS, only=[WRENCH])
    assert (graph.answers, graph.effort) == (1, 2.0)


def test_another_run_begins_with_nothing() -> None:
    """Halves, the newest late command and what was accepted are of the run before."""
    graph = Graph(paced=3)
    graph.port.expect(PERIOD)
    graph.hear(0, 1.0)
    graph.hear(PERIOD, 1.0, only=[WRENCH])
    graph.port.restart()
    assert (graph.port.answered, graph.port.take_newest(), list(graph.port.accepted.kept)) == (False, None, [])
    graph.hear(0, 2.0)
    assert graph.effort == 2.0
    graph.port.expect(PERIOD)
    graph.hear(PERIOD, 3.0, only=[JOINTS])
    assert not graph.port.answered


def test_of_two_controllers_the_one_whose_turn_it_is_not_answers_nothing() -> None:
    """By the name of its node, which may be known later than the node itself."""
    graph = Graph(paced=3, turns=Turns(2, PERIOD), senders={OURS: "/standby", THEIRS: ""})
    graph.hear(0, 1.0, OURS)
    assert graph.port.counts == {"out of turn": 2}
    assert all("out of turn: it is the turn of controller; published by /standby" in said for said in graph.warnings)
    graph.hear(0, 1.0, THEIRS)
    assert graph.port.counts == {"out of turn": 4}
    graph.known[THEIRS] = "/controller"
    graph.hear(0, 1.0, THEIRS)
    assert graph.effort == 1.0
    looks = graph.looks
    graph.port.expect(PERIOD)
    graph.hear(PERIOD, 1.0, THEIRS)
    assert graph.looks == looks
