"""Who publishes, from what the graph says: a change is reported once, whatever the order of discovery."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy")
from space_robot_msgs_py.topics import JOINT_COMMAND
from space_robot_sim.nodes.publishers import MAX_UNNAMED, UNNAMED, Publishers


def endpoint(process: int, name: str, number: int = 0) -> Any:
    """A publisher as the graph shows it."""
    return SimpleNamespace(node_name=name, node_namespace="/", endpoint_gid=[process] * 12 + [number] * 4)


class Graph:
    """What the graph shows at one time after another."""

    def __init__(self, usual: str | None = None) -> None:
        self.shown: list[Any] = []
        node: Any = SimpleNamespace(get_publishers_info_by_topic=lambda name: self.shown)
        self._publishers = Publishers(node, [JOINT_COMMAND], {JOINT_COMMAND: usual} if usual else None)

    def changes(self, *shown: Any) -> list[list[str]]:
        self.shown = list(shown)
        return [nodes for _, nodes in self._publishers.changes()]


def test_a_name_that_is_discovered_later_is_no_change() -> None:
    """The first publisher, its name, its end, its life cycle and its return are no news."""
    graph = Graph()
    again = endpoint(1, "controller", 7)
    for shown in (
        [],
        [endpoint(1, UNNAMED)],
        [endpoint(1, "controller")],
        [endpoint(1, "controller"), again],
        [],
        [again],
    ):
        assert graph.changes(*shown) == []


def test_a_second_and_another_publisher_are_reported_once() -> None:
    """Two at a time, two in one process, and another process after the first is gone."""
    graph = Graph()
    one, two = endpoint(1, "controller"), endpoint(2, "stranger")
    assert graph.changes(one) == []
    assert graph.changes(one, two) == [["/controller", "/stranger"]]
    assert graph.changes(one, two) == []
    assert graph.changes(two) == []
    assert graph.changes(endpoint(3, "controller")) == [["/controller"]]
    assert graph.changes(endpoint(3, "controller"), endpoint(3, "second", 1)) == [["/controller", "/second"]]


def test_a_first_publisher_of_another_name_is_reported_once() -> None:
    """The node that is meant to publish is no news; one of another project is, once it has a name."""
    assert Graph("controller").changes(endpoint(1, "controller")) == []
    graph = Graph("controller")
    assert graph.changes(endpoint(1, UNNAMED)) == []
    assert graph.changes(endpoint(1, "third_party")) == [["/third_party"]]
    assert graph.changes(endpoint(1, "third_party")) == []
    assert graph.changes() == []
    assert graph.changes(endpoint(1, "third_party", 9)) == []


def test_a_name_is_waited_for_but_not_for_ever() -> None:
    """A second publisher is reported with its name, or without one where it has none."""
    graph = Graph()
    one = endpoint(1, "controller")
    assert graph.changes(one) == []
    assert graph.changes(one, endpoint(2, UNNAMED)) == []
    assert graph.changes(one, endpoint(2, "stranger")) == [["/controller", "/stranger"]]
    other = Graph()
    reported = [other.changes(one, endpoint(2, UNNAMED)) for _ in range(MAX_UNNAMED + 2)]
    assert [bool(news) for news in reported].index(True) == MAX_UNNAMED - 1
    assert sum(map(bool, reported)) == 1
