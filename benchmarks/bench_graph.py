"""Lock-step in the graph: ticks per second with everything on, recorder included, beside the bare transport."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from rclpy.experimental import EventsExecutor

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import LIGHT, make_graph, spin, spin_graph
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.processes import run_processes
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import Topic, topics_of

CASE = "liu2023/fig08"
BARE = "one process, the same messages, nothing computed: ticks/s"
TICKS = 4000
REPEATS = 3
# The plant integrates in steps of 50 ms: five of them in the first period, two in the second.
PERIODS = (0.25, 0.1)


class Stopwatch:
    """Times the run between two ticks, so that start-up and discovery are not counted."""

    def __init__(self) -> None:
        self._first: tuple[int, float] | None = None
        self._last = (0, 0.0)

    def reach(self, tick: int) -> None:
        """The run has reached this tick."""
        if tick > TICKS // 10 and tick != self._last[0]:
            self._last = (tick, perf_counter())
            self._first = self._first or self._last

    @property
    def ticks_per_second(self) -> float:
        """Between the first and the last tick seen."""
        if self._first is None:
            return float("nan")
        return (self._last[0] - self._first[0]) / (self._last[1] - self._first[1])


class Echo(GraphNode):
    """A node that computes nothing: whenever it hears one topic it says all of its own.

    Args:
        name: node name.
        says: what it publishes, by topic.
        hears: topics it subscribes to; to the last one it answers.
        options: see GraphNode.
    """

    def __init__(self, name: str, says: dict[Topic, bytes], hears: Sequence[Topic], **options: Any) -> None:
        super().__init__(name, **options)
        self._says = [(self.publisher(topic), raw) for topic, raw in says.items()]
        self._answers = 0
        self.watch = Stopwatch()
        for topic in hears:
            self.listen(topic, self.speak if topic is hears[-1] and says else _ignore)

    def speak(self, _: bytes = b"") -> None:
        """Publish everything once; after ``TICKS`` times the run is over."""
        self._answers += 1
        self.watch.reach(self._answers)
        if self._answers > TICKS:
            self.end("completed")
            return
        for publisher, raw in self._says:
            publisher.publish(raw)


def run() -> dict[str, float]:
    """Ticks per second in one process and in four, and of the messages alone; median of three, interleaved."""
    table: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for repeat in range(REPEATS):
            for period in PERIODS:
                experiment = load_experiment(CASE).model_copy(update={"control_period": period})
                composition = compose(with_duration(experiment, TICKS * period))
                for mode, run_once in (("one process", _graph), ("four processes", _processes)):
                    row = f"{mode}, recorded, period {period:g} s: ticks/s"
                    place = Path(scratch) / f"{mode}_{period:g}_{repeat}"
                    table.setdefault(row, []).append(run_once(composition, place))
            table.setdefault(BARE, []).append(_transport(composition))
    return {row: median(speeds) for row, speeds in table.items()}


def _graph(composition: Composition, place: Path) -> float:
    watch = Stopwatch()
    with private_context() as context:
        graph = make_graph(composition, place, context=context)
        spin_graph(graph, context, Hooks(on_tick=watch.reach))
        for node in graph.nodes:
            node.destroy_node()
    return watch.ticks_per_second


def _processes(composition: Composition, place: Path) -> float:
    watch = Stopwatch()
    run_processes(composition, place, realtime=None, hooks=Hooks(on_tick=watch.reach))
    return watch.ticks_per_second


def _transport(composition: Composition) -> float:
    """The messages of one real tick go round between three nodes that look at none of them."""
    state, reference = composition.plant().reset(), composition.reference().at(0)
    output = composition.controller().update(state.state, reference)
    raws = TickCodec(composition.joint_names).encode(Tick(state, reference, output))
    messages = {topic: raw for topic, raw in zip(LOGGED, raws, strict=True) if raw is not None}
    world = {topic: raw for topic, raw in messages.items() if topic.publisher == "simulator"}
    mind = {topic: raw for topic, raw in messages.items() if topic.publisher != "simulator"}
    states, commands = topics_of("state"), topics_of("command")
    with private_context() as context:
        options: dict[str, Any] = {"context": context, **LIGHT}
        nodes = [Echo("recorder", {}, tuple(messages), **options), Echo("controller", mind, states, **options)]
        simulator = Echo("simulator", world, commands, **options)
        executor = EventsExecutor(context=context)
        for node in (*nodes, simulator):
            executor.add_node(node)
        simulator.speak()
        while simulator.end_reason is None:
            spin(executor, simulator)
        executor.shutdown()
        for node in (*nodes, simulator):
            node.destroy_node()
    return simulator.watch.ticks_per_second


def _ignore(_: bytes) -> None:
    """Take a message and do nothing."""
