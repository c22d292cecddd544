"""Begin and end of a run on two topics, which have no order among each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import monotonic

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import make_executor
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.run_messages import RunBegin, RunEnd, encode_begin, encode_end
from space_robot_msgs_py.topics import RUN_BEGIN, RUN_END

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
DEADLINE = 60.0
Until = Callable[[Callable[[], object]], None]


@pytest.fixture
def pair() -> Iterator[tuple[GraphNode, GraphNode, Until]]:
    """Who speaks and who listens, and what spins until a condition holds."""
    with private_context() as context:
        nodes = [GraphNode(name, context=context, start_parameter_services=False) for name in ("speaker", "listener")]
        executor = make_executor(context)
        for node in nodes:
            executor.add_node(node)

        def until(condition: Callable[[], object]) -> None:
            end = monotonic() + DEADLINE
            while not condition():
                executor.spin_once(timeout_sec=0.02)
                assert monotonic() < end

        yield nodes[0], nodes[1], until
        executor.shutdown()
        for node in nodes:
            node.destroy_node()


def test_an_end_that_comes_before_the_begin_ends_the_run(pair: tuple[GraphNode, GraphNode, Until]) -> None:
    """Or the node would wait for ever: it is said once."""
    speaker, listener, until = pair
    end, begin = speaker.publisher(RUN_END), speaker.publisher(RUN_BEGIN)
    end.publish(encode_end(RunEnd("ours", "/simulator", "completed")))
    until(lambda: listener.refusals[RUN_END.name])
    assert listener.end_reason is None
    begin.publish(encode_begin(RunBegin("ours", 0)))
    until(lambda: listener.end_reason)
    assert listener.end_reason == "completed"


def test_an_end_of_another_run_ends_nothing(pair: tuple[GraphNode, GraphNode, Until]) -> None:
    """However many there are; and the own one, when it comes, is heard."""
    speaker, listener, until = pair
    end, begin = speaker.publisher(RUN_END), speaker.publisher(RUN_BEGIN)
    for number in range(20):
        end.publish(encode_end(RunEnd(f"theirs {number}", "/simulator", "completed")))
        until(lambda seen=number + 1: listener.refusals[RUN_END.name] == seen)
    begin.publish(encode_begin(RunBegin("ours", 0)))
    until(lambda: "ours" in listener.runs)
    assert listener.end_reason is None
    end.publish(encode_end(RunEnd("ours", "/simulator", "completed")))
    until(lambda: listener.end_reason)
    assert listener.end_reason == "completed"


def test_an_end_may_be_said_later(pair: tuple[GraphNode, GraphNode, Until]) -> None:
    """A node that closes a log first has its reason at once, says it when asked, and once."""
    speaker, listener, until = pair
    speaker.publisher(RUN_BEGIN).publish(encode_begin(RunBegin("ours", 0)))
    until(lambda: "ours" in speaker.runs and "ours" in listener.runs)
    speaker.end("a process died", say=False)
    speaker.end("another reason")
    for _ in range(5):
        until(lambda: True)
    assert (speaker.end_reason, listener.end_reason) == ("a process died", None)
    speaker.say_end()
    until(lambda: listener.end_reason)
    speaker.say_end()
    assert listener.end_reason == "a process died"
    assert not speaker.refusals | listener.refusals
