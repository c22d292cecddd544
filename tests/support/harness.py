"""A graph in the test's own process, with a foreign node that can say anything on any topic."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import LIGHT, make_node
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_msgs_py.topics import Topic
from space_robot_sim.nodes.recorder import RecorderNode
from space_robot_sim.nodes.simulator import SimulatorNode

# Only a fault comes near it, however busy the machine is.
DEADLINE = 60.0
# More than the nodes that a message passes through one after another.
ROUNDS = 12


@dataclass
class RunningGraph:
    """Nodes of a run under the test's control."""

    composition: Composition
    context: Context
    executor: EventsExecutor
    nodes: dict[str, GraphNode]
    stranger: GraphNode
    directory: Path

    @property
    def simulator(self) -> SimulatorNode:
        node = self.nodes["simulator"]
        assert isinstance(node, SimulatorNode)
        return node

    @property
    def recorder(self) -> RecorderNode:
        node = self.nodes["recorder"]
        assert isinstance(node, RecorderNode)
        return node

    def spin_until(self, condition: Callable[[], object], what: str) -> None:
        """Spin until the condition holds; past the deadline say what was awaited and what was there."""
        end = monotonic() + DEADLINE
        while not condition():
            self.executor.spin_once(timeout_sec=0.02)
            assert monotonic() < end, f"waited {DEADLINE} s for {what}; the simulator is at tick {self.simulator.tick}"

    def settle(self) -> None:
        """Let the nodes take everything under way: in one process a message is with its readers once it is sent."""
        for _ in range(ROUNDS):
            mark = self.executor.create_task(lambda: None)
            self.spin_until(mark.done, "the executor")

    def await_answer(self) -> int:
        """Spin until the state at which a run stands has its answer; the tick of that state."""
        self.spin_until(lambda: self.simulator.started and self.simulator.commands.answered, "an answered state")
        return self.simulator.tick

    def spin_for(self, seconds: float) -> None:
        """Give what must not happen the time to happen."""
        end = monotonic() + seconds
        while monotonic() < end:
            self.executor.spin_once(timeout_sec=0.01)

    def publish(self, topic: Topic, raw: bytes) -> None:
        """The foreign node publishes raw bytes."""
        if topic not in self._speakers:
            self._speakers[topic] = self.stranger.publisher(topic)
        self._speakers[topic].publish(raw)

    def __post_init__(self) -> None:
        self._speakers: dict[Topic, Any] = {}


@contextmanager
def running_graph(
    directory: Path,
    *overrides: str,
    experiment: str = "liu2023/fig08",
    roles: tuple[str, ...] = ("recorder", "guidance", "controller", "simulator"),
    realtime: float | None = None,
    services: bool = False,
    failover: int = 0,
) -> Iterator[RunningGraph]:
    """A composed graph with the given roles in one private context; the recorder's log is closed at the end.

    With ``services`` the nodes have those of parameters and of the life cycle, as nodes of their own processes have.
    """
    composition = compose(load_experiment(experiment, overrides))
    with private_context() as context:
        options: dict[str, Any] = {"context": context, **({} if services else LIGHT)}
        mode = "processes" if services else "graph"
        nodes = {
            role: make_node(role, composition, directory, realtime=realtime, mode=mode, failover=failover, **options)
            for role in roles
        }
        bring_up(nodes.values())
        stranger = GraphNode("stranger", **options)
        executor = EventsExecutor(context=context)
        for node in (*nodes.values(), stranger):
            executor.add_node(node)
        made = RunningGraph(composition, context, executor, nodes, stranger, directory)
        try:
            yield made
        finally:
            if "recorder" in nodes:
                made.recorder.finish("test over")
            executor.shutdown()
            for node in (*nodes.values(), stranger):
                node.destroy_node()
