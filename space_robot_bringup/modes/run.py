"""One run in any mode: objects together, log in a directory, verdict out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.controller import check_made_here
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.conclusion import conclusion, passed
from space_robot_bringup.judge.judging import Judge
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.remarks import Remark
from space_robot_bringup.judge.verdict import check_end
from space_robot_bringup.modes import headless
from space_robot_bringup.modes.hooks import Hooks, Stopwatch
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.extras import install
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.run_directory import GONE, RunDirectory
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import Kind, topics_of
from space_robot_sim.nodes.tick_parts import MAX_LATE

Mode = Literal["headless", "graph", "processes"]
MODES: tuple[Mode, ...] = get_args(Mode)
KINDS: tuple[Kind, ...] = ("state", "reference", "command")


@dataclass(frozen=True, slots=True)
class RunResult:
    """What a run left behind.

    Attributes:
        directory: the bag.
        end_reason: ``completed``, ``interrupted``, ``terminated``, ``timeout``, ``truncated`` or an error.
        metrics: None where no tick was completed.
        checks: the verdict, bound by bound.
        wall_time: [s] from the first tick to the last; set-up is not counted.
        remarks: what else happened, whatever was expected.
    """

    directory: Path
    end_reason: str
    metrics: RunMetrics | None
    checks: tuple[Check, ...]
    wall_time: float
    remarks: tuple[Remark, ...] = ()

    @property
    def passed(self) -> bool | None:
        """Every bound holds, one at least of the task; None: they hold, but nothing was expected of the task."""
        return passed(self.checks)

    @property
    def conclusion(self) -> str:
        """``PASS``, ``FAIL``, or in words that nothing was expected."""
        return conclusion(self.checks)


def run_experiment(
    experiment: Experiment,
    directory: StrPath,
    *,
    mode: Mode,
    realtime: float | None = None,
    hooks: Hooks | None = None,
    policy: LawPolicy = TYPED,
    failover: int = 0,
    chaos: int | None = None,
) -> RunResult:
    """Run an experiment, log it and judge it from the log.

    Args:
        experiment: what to run.
        directory: where the bag goes.
        mode: how the objects are put together; it changes no bit of the log.
        realtime: simulated seconds per second; None: as fast as it goes. Not for headless.
        hooks: progress and early end.
        policy: whose code may be its laws.
        failover: periods of silence after which a second controller takes over; 0: there is none. Paced, processes.
        chaos: seed of what is done to the processes; None: nothing. Paced, processes.

    Raises:
        SpaceRobotError: the experiment cannot be composed or the directory cannot be written; nothing was run.
    """
    check_pace(mode, realtime)
    check_processes(mode, realtime, failover, chaos)
    processes: dict[str, Any] = {"failover": failover, "chaos": chaos}
    composition = compose(experiment, policy)
    return run_composition(composition, directory, mode=mode, realtime=realtime, hooks=hooks, **processes)


def check_processes(mode: str, realtime: float | None, failover: int, chaos: int | None) -> None:
    """Refuse what needs processes and a clock.

    Raises:
        SpecError: ``failover`` or ``chaos`` in another run, or a number of periods that cannot be.
    """
    for key, value in (("--failover", failover or None), ("--chaos", chaos)):
        if value is not None and (mode != "processes" or realtime is None):
            raise SpecError("is for paced processes", key=key, value=value, accepted="--mode processes --realtime F")
    if not 0 <= failover <= MAX_LATE:
        raise SpecError("not a number of periods", key="--failover", value=failover, accepted=f"1 to {MAX_LATE}")


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
    **processes: Any,
) -> RunResult:
    """Run a composed experiment; everything else as ``run_experiment``."""
    hooks = hooks or Hooks()
    check_made_here(composition.experiment.controller)
    _check_laws(composition, mode)
    for warning in composition.review().warnings:
        hooks.warn(warning)
    stopwatch = Stopwatch(hooks)
    # Locked until it is judged: what is judged is what was written.
    with RunDirectory(Path(directory)) as place:
        reason = _execute(composition, place, mode, realtime, stopwatch.hooks, **processes)
        if not place.holds_path() and reason == "completed":
            reason = f"recorder: {place.bag}: {GONE}"
        hooks.on_end(reason)
        return judge_log(Path(directory), composition, reason, stopwatch.seconds)


def _check_laws(composition: Composition, mode: Mode) -> None:
    """Refuse a law that other processes cannot import."""
    for law in composition.experiment.controller.law_names if mode == "processes" else ():
        if law.startswith("__main__:"):
            accepted = "--mode headless or graph, or a law in a file, FILE.py:Class"
            raise SpecError("is known to this program only", key="controller.law", value=law, accepted=accepted)


def judge_log(directory: Path, composition: Composition, reason: str, wall_time: float) -> RunResult:
    """The result of a run, read back from its log.

    Args:
        directory: of the run.
        composition: of the run.
        reason: of the end, as the run said it; the log's own counts where it has one.
        wall_time: [s].
    """
    try:
        # Resolved as the writer did: `a/../b` is a place even where there is no `a`.
        reader, judging = LogReader(directory.resolve()), Judge(composition)
        for block in reader.event_blocks():
            judging.add_log(block)
        logged = reader.end_reason
    except SpaceRobotError as error:
        reason = f"recorder: {error}" if reason == "completed" else reason
        return RunResult(directory, reason, None, (check_end(reason),), wall_time)
    if reason == "completed":
        reason = "truncated" if logged is None else logged
    elif logged not in (None, "completed"):
        reason = str(logged)
    judged = judging.verdict(reason, Lacks(reader, composition))
    return RunResult(directory, reason, judged.metrics, judged.checks, wall_time, judged.remarks)


class Lacks:
    """Says what a tick of a log lacks that is not complete.

    Args:
        reader: of the log.
        composition: of the run.
    """

    def __init__(self, reader: LogReader, composition: Composition) -> None:
        self._reader, self._experiment = reader, composition.experiment

    def __call__(self, tick: int) -> str:
        """What this tick lacks; nothing where that is not known."""
        stamp = tick * self._experiment.period
        try:
            parts = next((parts for at, parts in self._reader.stamps() if at == stamp), {})
        except SpaceRobotError:
            return ""
        absent = [kind for kind in KINDS if any(topic.name not in parts for topic in topics_of(kind))]
        if absent == ["command"]:
            return f"has no command of the law {self._experiment.controller.law}"
        return f"has no {', no '.join(absent)}" if absent else ""


def _execute(
    composition: Composition,
    directory: RunDirectory,
    mode: Mode,
    realtime: float | None,
    hooks: Hooks,
    **processes: Any,
) -> str:
    if mode == "headless":
        # The log last: what cannot be made leaves none behind.
        plant, controller, reference = composition.plant(), composition.controller(), composition.reference()
        supervisor = composition.supervisor(controller)
        sink = LogSink(directory, composition.header, custom={"mode": mode})
        return headless.run(
            plant,
            controller,
            reference,
            steps=composition.experiment.steps,
            sink=sink,
            supervisor=supervisor,
            on_tick=hooks.on_tick,
            stop=hooks.stop,
            on_failure=hooks.on_failure,
        )
    try:
        # Only here: everything else works on a machine without ROS.
        from space_robot_bringup.modes.graph import run_graph
        from space_robot_bringup.modes.processes import run_processes
    except ImportError as error:
        raise SpecError(
            f"needs ROS 2 Jazzy ({error})",
            key="--mode",
            value=mode,
            accepted=f"headless, or a sourced Jazzy, or {install('ros')}",
        ) from None
    if mode == "graph":
        return run_graph(composition, directory, realtime=realtime, hooks=hooks)
    return run_processes(composition, directory, realtime=realtime, hooks=hooks, **processes)
