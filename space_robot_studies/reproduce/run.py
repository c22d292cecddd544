"""One run in a worker: done, judged, and only the numbers that figures need brought back."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.fused.sink import FusedRun
from space_robot_bringup.judge.judging import judge_memory
from space_robot_bringup.judge.verdict import PLANT_BOUNDS
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_description.kernel import jit
from space_robot_msgs_py.errors import NonFiniteError, SpaceRobotError
from space_robot_msgs_py.log.writer import MemorySink
from space_robot_studies.engine.worker import bug
from space_robot_studies.reproduce.measures import take
from space_robot_studies.reproduce.quantities import Quantity
from space_robot_studies.reproduce.run_data import RunData
from space_robot_studies.reproduce.signals import Signals

# A picture is about this many dots wide; curves of longer runs are drawn by every k-th tick.
DRAWN_TICKS = 2000
Keep = Literal["all", "failed", "none"]


@dataclass(frozen=True, slots=True)
class Job:
    """What a worker is to do.

    Attributes:
        argument: experiment, as ``load_experiment`` takes it.
        overrides: likewise.
        directory: of the bag.
        quantities: to be taken of signals.
        curves: signals to be drawn.
        keep: whether the bag stays.
    """

    argument: str
    overrides: tuple[str, ...]
    directory: Path
    quantities: tuple[Quantity, ...]
    curves: tuple[str, ...]
    keep: Keep

    def digest(self, experiment: Experiment, robot: Mapping[str, Any]) -> str:
        """Changes with everything that its result depends on, but the code.

        Args:
            experiment: what is run.
            robot: content of its robot file.
        """
        wanted = [[asdict(quantity) for quantity in self.quantities], self.curves, self.keep]
        content = [experiment.model_dump_json(), dict(robot), *wanted]
        return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def run_job(job: Job) -> RunData:
    """Do a job; a run that fails is a result, not an error.

    Raises:
        SpaceRobotError: the log cannot be written.
    """
    try:
        composition = compose(load_experiment(job.argument, job.overrides))
    except SpaceRobotError as error:
        # A draw of a campaign; all else was composed before.
        return RunData(f"cannot be run: {error}")
    warnings = composition.review().warnings
    try:
        sink = run_in_memory(composition)
    except (Exception, SystemExit) as error:
        # Nothing can be measured of it, and of its log nothing is known to be whole.
        return RunData(bug(error), warnings=warnings)
    return _finished(job, composition, sink, warnings)


def run_jobs(jobs: Sequence[tuple[Job]]) -> list[RunData | None]:
    """Do jobs side by side where that can be; see ``run_job``.

    Args:
        jobs: its arguments.

    Returns:
        Results in their order; None: only ``run_job`` can tell.

    Raises:
        SpaceRobotError: a log cannot be written.
    """
    if not jit.MACHINE_CODE:
        return [None for _ in jobs]
    # Only here: it needs a compiler.
    from space_robot_bringup.fused.lanes import compiled_runs

    composed = [_composed(job) for (job,) in jobs]
    runs = iter(compiled_runs([one for one in composed if one is not None]))
    found: list[RunData | None] = []
    for one, (job,) in zip(composed, jobs, strict=True):
        sink = None if one is None else next(runs)
        if one is None or sink is None:
            found.append(None)
        else:
            found.append(_finished(job, one, sink, one.review().warnings))
    return found


def _composed(job: Job) -> Composition | None:
    try:
        return compose(load_experiment(job.argument, job.overrides))
    except SpaceRobotError:
        return None


def _finished(job: Job, composition: Composition, sink: MemorySink | FusedRun, warnings: tuple[str, ...]) -> RunData:
    try:
        data = _look(job, composition, sink)
    except NonFiniteError as error:
        # It was run, but its numbers overflow when they are judged.
        data = RunData(str(error))
    keep = job.keep == "all" or (job.keep == "failed" and not data.completed)
    if keep:
        write_bag(sink, composition, job.directory)
    return replace(data, warnings=warnings, bag=keep)


def _look(job: Job, composition: Composition, sink: MemorySink | FusedRun) -> RunData:
    reason = sink.end_reason or ""
    metrics, checks, _ = judge_memory(sink, composition)
    if metrics is None:
        return RunData(reason)
    arrays = sink.arrays
    signals = Signals(arrays, composition)
    stride = max(1, arrays.time.size // DRAWN_TICKS)
    drawn = np.unique(np.append(np.arange(0, arrays.time.size, stride), arrays.time.size - 1))
    return RunData(
        end_reason=reason,
        broken=tuple(check.name for check in checks if check.name in PLANT_BOUNDS and not check.passed),
        metrics=metrics.flat(),
        largest=_largest(signals),
        taken={wanted: take(wanted, arrays.time, signals.of(wanted.signal)) for wanted in job.quantities},
        time=arrays.time[drawn],
        curves={name: signals.of(name)[drawn] for name in job.curves},
    )


def _largest(signals: Signals) -> dict[str, float]:
    """The largest errors, by the names of ``Bounds``."""
    names = {"attitude": "base.error", "joints": "joints.error"}
    if signals.composition.nominal.base_mode == "free_flying":
        names["position"] = "base.position_error"
    return {bound: float(signals.of(name).max()) for bound, name in names.items()}
