"""Lock-step in the graph: ticks per second with everything on, recorder included."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from space_robot_bringup.compose import compose
from space_robot_bringup.experiment import load_experiment, with_duration
from space_robot_bringup.graph import make_graph, private_context, spin_graph
from space_robot_bringup.processes import fly_processes
from space_robot_bringup.run import Hooks

TICKS = 4000
REPEATS = 3


class Stopwatch:
    """Times the flight between two ticks, so that start-up and discovery are not counted."""

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
        assert self._first is not None
        return (self._last[0] - self._first[0]) / (self._last[1] - self._first[1])


def run() -> dict[str, float]:
    """Ticks per second in one process and in four; median of three."""
    experiment = load_experiment("liu2023/fig08")
    composition = compose(with_duration(experiment, TICKS * experiment.period / 1e9))
    speeds: dict[str, list[float]] = {"graph": [], "processes": []}
    with tempfile.TemporaryDirectory() as scratch:
        for repeat in range(REPEATS):
            watch = Stopwatch()
            with private_context() as context:
                graph = make_graph(composition, Path(scratch) / f"graph{repeat}", context=context)
                spin_graph(graph, context, Hooks(on_tick=watch.reach))
                for node in graph.nodes:
                    node.destroy_node()
            speeds["graph"].append(watch.ticks_per_second)
            watch = Stopwatch()
            place = Path(scratch) / f"processes{repeat}"
            fly_processes(composition, place, realtime=None, hooks=Hooks(on_tick=watch.reach))
            speeds["processes"].append(watch.ticks_per_second)
    return {
        "one process, four nodes, recorded: ticks/s": median(speeds["graph"]),
        "four processes, recorded: ticks/s": median(speeds["processes"]),
    }
