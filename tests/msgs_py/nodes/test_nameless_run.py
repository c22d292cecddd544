"""A run of which a node hears the end and never the name, and what is none of it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import LIGHT, make_executor
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.run_messages import RunBegin, RunEnd, encode_begin, encode_end
from space_robot_msgs_py.topics import RUN_END

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


class Listener(GraphNode):
    """A node that has seen states of a run, or not."""

    heard = False

    @property
    def begun(self) -> bool:
        return self.heard


@pytest.fixture
def node() -> Iterator[Listener]:
    """Alone in its context; what it hears is given to it."""
    with private_context() as context:
        made = Listener("listener", context=context, **LIGHT)
        yield made
        made.destroy_node()


def begin(node: GraphNode, run: str) -> None:
    node._on_run_begin(encode_begin(RunBegin(run, 0)))


def end(node: GraphNode, run: str, reason: str = "completed") -> None:
    node._on_run_end(encode_end(RunEnd(run, "/simulator", reason)))


def test_an_end_that_is_heard_before_the_name_of_its_run_counts_with_it(node: Listener) -> None:
    """Topics have no order: the begin may be under way when the end is here, and then the run is over."""
    node.heard = True
    end(node, "a")
    assert node.end_reason is None
    begin(node, "b")
    assert node.end_reason is None, "another run"
    begin(node, "a")
    assert node.end_reason == "completed"


def test_a_node_that_saw_states_and_never_a_name_ends_with_its_run(node: Listener) -> None:
    """A simulator that is gone says its name no more: half a second after the end the node ends, too."""
    node.heard = True
    executor = make_executor(node.context)
    executor.add_node(node)
    end(node, "a", "interrupted")
    executor.spin_until_future_complete(node.over, timeout_sec=60.0)
    executor.shutdown()
    assert node.end_reason == "interrupted"


def test_a_node_that_saw_nothing_is_not_ended_by_a_run_it_does_not_know(node: Listener) -> None:
    """The end of a run before, still in the graph, is none of the run that the node waits for."""
    end(node, "old")
    node._end_without_name()
    assert node.end_reason is None
    begin(node, "new")
    node.heard = True
    end(node, "old")
    assert node.refusals[RUN_END.name] == 2
    node._end_without_name()
    assert node.end_reason is None
    end(node, "new")
    assert node.end_reason == "completed"
