"""One run in any mode: objects together, log in a directory, verdict out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Literal, get_args

from space_robot_bringup import closed_loop
from space_robot_bringup.compose import Composition, compose
from space_robot_bringup.experiment import Experiment
from space_robot_bringup.metrics import RunMetrics, measure
from space_robot_bringup.verdict import Check, judge
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log_reader import LogReader
from space_robot_msgs_py.log_writer import LogSink
from space_robot_msgs_py.paths import StrPath

Mode = Literal["headless", "graph", "processes"]
MODES: tuple[Mode, ...] = get_args(Mode)


@dataclass(frozen=True, slots=True)
class Hooks:
    """How a run talks to whoever started it.

    Attributes:
        on_tick: told each finished tick.
        stop: asked often; a reason ends the run.
        warn: told before the flight what the law warns of.
    """

    on_tick: Callable[[int], None] = lambda tick: None
    stop: Callable[[], str | None] = lambda: None
    warn: Callable[[str], None] = lambda warning: None


@dataclass(frozen=True, slots=True)
class RunResult:
    """What a run left behind.

    Attributes:
        directory: the bag.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or an error.
        metrics: None where no tick was completed.
        checks: the verdict, bound by bound.
        wall_time: [s] from the first tick to the last; set-up is not counted.
    """

    directory: Path
    end_reason: str
    metrics: RunMetrics | None
    checks: tuple[Check, ...]
    wall_time: float

    @property
    def passed(self) -> bool:
        """Every bound holds."""
        return bool(self.checks) and all(check.passed for check in self.checks)


def run_experiment(
    experiment: Experiment, directory: StrPath, *, mode: Mode, realtime: float | None = None, hooks: Hooks | None = None
) -> RunResult:
    """Fly an experiment, log it and judge it from the log.

    Args:
        experiment: what to fly.
        directory: where the bag goes.
        mode: how the objects are put together; it changes no bit of the log.
        realtime: simulated seconds per second; None: as fast as it goes. Not for headless.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the experiment cannot be composed or the directory cannot be written; nothing was flown.
    """
    check_pace(mode, realtime)
    return run_composition(compose(experiment), directory, mode=mode, realtime=realtime, hooks=hooks)


def check_pace(mode: str, realtime: float | None) -> None:
    """Refuse a mode there is not, and a pace that it cannot keep.

    Raises:
        SpecError: either cannot be used.
    """
    if mode not in MODES:
        raise SpecError("no such mode", key="--mode", value=mode, accepted=", ".join(MODES))
    if realtime is not None and not 1e-3 <= realtime <= 1e4:
        raise SpecError("not a usable factor", key="--realtime", value=realtime, accepted="0.001 to 10000")
    if mode == "headless" and realtime is not None:
        raise SpecError("has no wall clock", key="--realtime", value=realtime, accepted="--mode graph or processes")


def run_composition(
    composition: Composition,
    directory: StrPath,
    *,
    mode: Mode,
    realtime: float | None = None,
    hooks: Hooks | None = None,
) -> RunResult:
    """Fly what an experiment was composed to; everything else as ``run_experiment``."""
    hooks, place = hooks or Hooks(), Path(directory)
    for warning in composition.review().warnings:
        hooks.warn(warning)
    stopwatch = Stopwatch(hooks)
    reason = _fly(composition, place, mode, realtime, stopwatch.hooks)
    return judge_log(place, composition, reason, stopwatch.seconds)


class Stopwatch:
    """Times a flight from its first to its last tick, so that imports, compilation and discovery are not counted.

    Args:
        hooks: whom to pass everything on to.
    """

    def __init__(self, hooks: Hooks) -> None:
        self._on_tick = hooks.on_tick
        self._first: float | None = None
        self._last = 0.0
        self.hooks = Hooks(on_tick=self._reach, stop=hooks.stop)

    @property
    def seconds(self) -> float:
        """[s] between the first and the last tick seen."""
        return 0.0 if self._first is None else self._last - self._first

    def _reach(self, tick: int) -> None:
        if tick >= 0:
            self._last = perf_counter()
            if self._first is None:
                self._first = self._last
        self._on_tick(tick)


def judge_log(directory: Path, composition: Composition, reason: str, wall_time: float) -> RunResult:
    """The result of a run, read back from its log."""
    # Resolved as the writer did: `a/../b` is a place even where there is no `a`.
    ticks = list(LogReader(directory.resolve()).ticks())
    metrics, checks = judge_ticks(ticks, composition, reason)
    return RunResult(directory, reason, metrics, checks, wall_time)


def judge_ticks(
    ticks: Sequence[Tick], composition: Composition, reason: str
) -> tuple[RunMetrics | None, tuple[Check, ...]]:
    """Metrics and verdict of a run; None and nothing where no tick was completed."""
    if not ticks:
        return None, ()
    flying = composition.nominal.base_mode == "free_flying"
    metrics = measure(
        ticks,
        composition.joint_names,
        base_translation=flying,
        prismatic=composition.nominal.prismatic,
        bands=composition.experiment.settling_bands,
    )
    return metrics, judge(metrics, composition.experiment.expect, reason)


def _fly(composition: Composition, directory: Path, mode: Mode, realtime: float | None, hooks: Hooks) -> str:
    if mode == "headless":
        # The log last: what cannot be made leaves none behind.
        plant, controller, reference = composition.plant(), composition.controller(), composition.reference()
        sink = LogSink(directory, composition.header, custom={"mode": mode})
        return closed_loop.run(
            plant,
            controller,
            reference,
            steps=composition.experiment.steps,
            sink=sink,
            on_tick=hooks.on_tick,
            stop=hooks.stop,
        )
    try:
        # Only here: everything else works on a machine without ROS.
        from space_robot_bringup.graph import fly_graph
        from space_robot_bringup.processes import fly_processes
    except ImportError as error:
        raise SpecError(
            f"needs ROS 2 Jazzy ({error})",
            key="--mode",
            value=mode,
            accepted="headless, or install space-robot[ros], or source a Jazzy",
        ) from None
    fly = fly_graph if mode == "graph" else fly_processes
    return fly(composition, directory, realtime=realtime, hooks=hooks)
