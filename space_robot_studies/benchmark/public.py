"""`space_robot.benchmark`: laws tuned under equal rules and judged in pairs, beside the shipped results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from space_robot_bringup.public.calls import for_python, needing
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.benchmark.run import BenchmarkResult
    from space_robot_studies.engine.hooks import StudyHooks


@for_python
def benchmark(
    file: StrPath = "v1",
    *,
    law: Sequence[str] = (),
    task: Sequence[str] = (),
    only: Sequence[str] = (),
    short: bool = False,
    out: StrPath = "out/benchmark",
    table: StrPath | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> BenchmarkResult:
    """Tune laws on the tasks of a benchmark and judge them on draws that no search sees.

    The rows depend neither on the number of workers nor on what else is run with them.

    Args:
        file: a shipped name such as ``v1``, or the path of a YAML file.
        law: of the set, or ``module:Class`` and ``file.py:Class``; none: all of the set.
        task: only these; none: all.
        only: ``KEY=LABEL`` of what is varied, e.g. ``control_period=0.5``: only these points.
        short: the part of the set that is over in minutes.
        out: directory of the searches.
        table: file of results to enter the rows in; None: ``table.json`` in ``out``. A new one begins with what is
            shipped.
        workers: local worker processes; None: one per core.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of an evaluation; ten times as much may elapse.
        hooks: progress and early end.

    Returns:
        The table with the rows of this run entered, and why it ended.

    Raises:
        SpaceRobotError: the input cannot be used as it is, or a package is not installed, and nothing was written; or
            no evaluation came to a number.
    """
    with needing("benchmark", "campaign"):
        from space_robot_studies.benchmark.run import laws_of, run_benchmark
    from space_robot_studies.benchmark.spec import benchmark_path, load_benchmark

    found = load_benchmark(file, short=short, only=tuple(only))
    return run_benchmark(
        found,
        benchmark_path(file),
        Path(out),
        laws=laws_of(found, tuple(law), Path.cwd()),
        tasks=tuple(task),
        table=None if table is None else Path(table),
        workers=workers,
        resume=resume,
        time_limit=time_limit,
        hooks=hooks,
    )
