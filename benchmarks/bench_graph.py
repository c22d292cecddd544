"""Lock-step in the graph: ticks per second with everything on, recorder included, beside the bare transport.

The ratio of the two is one of CPU times per tick, both of one run, taking turns, the least of each: a machine that
others use moves times, and both sides alike. ``python -m benchmarks.older COMMIT`` measures another commit beside it.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

from rclpy.experimental import EventsExecutor

from benchmarks.hops import go_round
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
BARE = "one process, the same messages, nothing computed"
HOPS = "one process, the same messages on the same ways, an addition in each node"
RATIO = "one process, recorded: times the speed of the same messages, nothing computed"
TICKS = 1000
STRETCH = 5
REPEATS = 5
# The plant integrates in steps of 50 ms: five of them in the first period, two in the second.
PERIODS = (0.25, 0.1)


class Stopwatch:
    """Times the run between two ticks, so that start-up and discovery are not counted.

    CPU time is that of the fastest stretch of ``STRETCH`` ticks: on a busy machine others take caches, and time that is
    counted as this process's, from nearly all stretches.

    Args:
        ticks: of the run.
    """

    def __init__(self, ticks: int) -> None:
        self._begin = ticks // 10
        self._first: tuple[int, float] | None = None
        self._last, self._cpu = (0, 0.0), float("nan")
        self._least = float("inf")

    def reach(self, tick: int) -> None:
        """The run has reached this tick."""
        if tick <= self._begin or tick == self._last[0]:
            return
        self._last = tick, perf_counter()
        self._first = self._first or self._last
        if tick % STRETCH == 0:
            before, self._cpu = self._cpu, process_time()
            # Of the first stretch nothing is known: no number is less than this one.
            self._least = min(self._least, self._cpu - before)

    @property
    def seconds_per_tick(self) -> tuple[float, float]:
        """Wall time between the first and the last tick seen, and CPU time of this process."""
        if self._first is None or self._last[0] == self._first[0]:
            return float("nan"), float("nan")
        return (self._last[1] - self._first[1]) / (self._last[0] - self._first[0]), self._least / STRETCH


class Echo(GraphNode):
    """A node that computes nothing: whenever it hears one topic it says all of its own.

    Args:
        name: node name.
        says: what it publishes, by topic.
        hears: topics it subscribes to; to the last one it answers.
        ticks: of the run.
        options: see GraphNode.
    """

    def __init__(self, name: str, says: dict[Topic, bytes], hears: Sequence[Topic], ticks: int, **options: Any) -> None:
        super().__init__(name, **options)
        self._ticks = ticks
        self._says = [(self.publisher(topic), raw) for topic, raw in says.items()]
        self._answers = 0
        self.watch = Stopwatch(ticks)
        for topic in hears:
            self.listen(topic, self.speak if topic is hears[-1] and says else _ignore)

    def speak(self, _: bytes = b"") -> None:
        """Publish everything once; after so many times the run is over."""
        self._answers += 1
        self.watch.reach(self._answers)
        if self._answers > self._ticks:
            self.end("completed")
            return
        for publisher, raw in self._says:
            publisher.publish(raw)


def run() -> dict[str, float]:
    """Ticks per second in one process and in four, and of the messages alone; medians, least CPU times, in turns."""
    walls: dict[str, list[float]] = {}
    cpus: dict[str, list[float]] = {}
    with _scratch() as scratch:
        for repeat in range(REPEATS):
            for period in PERIODS:
                composition = _composition(period, TICKS)
                for mode, run_once in (("one process", _graph), ("four processes", _processes)):
                    row, place = f"{mode}, recorded, period {period:g} s", Path(scratch) / f"{mode}_{period:g}_{repeat}"
                    _note(row, run_once(composition, place, TICKS), walls, cpus)
            _note(BARE, _transport(composition, TICKS), walls, cpus)
            _note(HOPS, _hops(TICKS), walls, cpus)
    table = {f"{row}: ticks/s": 1.0 / median(times) for row, times in walls.items()}
    # Of processes of their own this one knows no CPU time.
    table |= {f"{row}: us of CPU per tick": 1e6 * min(times) for row, times in cpus.items() if "four" not in row}
    for period in PERIODS:
        own = cpus[f"one process, recorded, period {period:g} s"]
        table[f"{RATIO}, period {period:g} s"] = min(cpus[BARE]) / min(own)
    return table


def beside_bare(ticks: int, repeats: int) -> float:
    """How many times as fast as the bare messages the graph is, recorder included, at 0.1 s, by CPU time.

    Args:
        ticks: of each run.
        repeats: turns; the least time of each side counts.
    """
    composition = _composition(PERIODS[1], ticks)
    own, bare = list[float](), list[float]()
    with _scratch() as scratch:
        for repeat in range(repeats):
            own.append(_graph(composition, Path(scratch) / f"run{repeat}", ticks)[1])
            bare.append(_transport(composition, ticks)[1])
    return min(bare) / min(own)


def _scratch() -> tempfile.TemporaryDirectory[str]:
    """Where logs go: to memory where that can be, for what a disk does that others write to is not the graph's."""
    memory = Path("/dev/shm")
    return tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None)


def _note(row: str, found: tuple[float, float], *tables: dict[str, list[float]]) -> None:
    for table, seconds in zip(tables, found, strict=True):
        table.setdefault(row, []).append(seconds)


def _composition(period: float, ticks: int) -> Composition:
    experiment = load_experiment(CASE).model_copy(update={"control_period": period})
    return compose(with_duration(experiment, ticks * period))


def _graph(composition: Composition, place: Path, ticks: int) -> tuple[float, float]:
    watch = Stopwatch(ticks)
    with private_context() as context:
        graph = make_graph(composition, place, context=context)
        spin_graph(graph, context, Hooks(on_tick=watch.reach))
        for node in graph.nodes:
            node.destroy_node()
    return watch.seconds_per_tick


def _processes(composition: Composition, place: Path, ticks: int) -> tuple[float, float]:
    watch = Stopwatch(ticks)
    run_processes(composition, place, realtime=None, hooks=Hooks(on_tick=watch.reach))
    return watch.seconds_per_tick


def _messages(composition: Composition) -> dict[Topic, bytes]:
    """Those of one real tick."""
    state, reference = composition.plant().reset(), composition.reference().at(0)
    output = composition.controller().update(state.state, reference)
    raws = TickCodec(composition.joint_names).encode(Tick(state, reference, output))
    return {topic: raw for topic, raw in zip(LOGGED, raws, strict=True) if raw is not None}


def hops(ticks: int, on_tick: Callable[[int], None]) -> dict[str, int]:
    """The messages of a tick between the four nodes of a run, which are rclpy's own and add one to some numbers.

    Args:
        ticks: how often they go round.
        on_tick: called with the number of each, from 1.

    Returns:
        How many messages each node takes in a tick.
    """
    with private_context() as context:
        return go_round(_messages(_composition(PERIODS[1], TICKS)), ticks, on_tick, context)


def _hops(ticks: int) -> tuple[float, float]:
    watch = Stopwatch(ticks)
    hops(ticks, watch.reach)
    return watch.seconds_per_tick


def _transport(composition: Composition, ticks: int) -> tuple[float, float]:
    """The messages of one real tick go round between three nodes that look at none of them."""
    messages = _messages(composition)
    world = {topic: raw for topic, raw in messages.items() if topic.publisher == "simulator"}
    mind = {topic: raw for topic, raw in messages.items() if topic.publisher != "simulator"}
    states, commands = topics_of("state"), topics_of("command")
    with private_context() as context:
        options: dict[str, Any] = {"context": context, **LIGHT}
        nodes = [
            Echo("recorder", {}, tuple(messages), ticks, **options),
            Echo("controller", mind, states, ticks, **options),
        ]
        simulator = Echo("simulator", world, commands, ticks, **options)
        executor = EventsExecutor(context=context)
        for node in (*nodes, simulator):
            executor.add_node(node)
        simulator.speak()
        while simulator.end_reason is None:
            spin(executor, simulator)
        executor.shutdown()
        for node in (*nodes, simulator):
            node.destroy_node()
    return simulator.watch.seconds_per_tick


def _ignore(_: bytes) -> None:
    """Take a message and do nothing."""
