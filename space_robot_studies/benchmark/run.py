"""One benchmark from beginning to end: every task tuned and judged, the rows entered in a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from space_robot_control.laws.registry import law_class
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.benchmark.spec import Benchmark, chosen
from space_robot_studies.benchmark.table import Table, first_table, row_of
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.engine.storage import check_place
from space_robot_studies.engine.tasks import TIME_LIMIT
from space_robot_studies.tune.directory import check_directory
from space_robot_studies.tune.spec import TunedLaw, Tuning
from space_robot_studies.tune.tune import run_tuning

TABLE = "table.json"


@dataclass(frozen=True, slots=True)
class BenchmarkResult:
    """What a benchmark came to.

    Attributes:
        directory: a folder per task.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        table: with the rows of all tasks that are done.
        passed: it came to its end, and every law has gains that keep the constraints.
    """

    directory: Path
    end_reason: str
    table: Table
    passed: bool


def laws_of(benchmark: Benchmark, names: Sequence[str], folder: Path) -> dict[str, TunedLaw]:
    """The laws that take part: of the file, or ``module:Class`` and ``file.py:Class`` with what they declare.

    Args:
        benchmark: knows some by name.
        names: as typed; none: all of the file.
        folder: where a path that was typed starts.

    Raises:
        SpecError: there is no such law.
    """
    found = {}
    for name in names:
        if ":" not in name:
            known = chosen(name, benchmark.laws, "--law")
            found[known] = benchmark.laws[known]
            continue
        file, _, cls = name.rpartition(":")
        whole = f"{(folder / file).resolve()}:{cls}" if file.endswith(".py") else name
        law = law_class(whole, "--law")
        label = law.name or law.__name__
        if label in benchmark.laws or label in found:
            raise SpecError("has the name of another law", key="--law", value=label, accepted="a name of its own")
        found[label] = TunedLaw(law=whole)
    return found or dict(benchmark.laws)


def run_benchmark(
    benchmark: Benchmark,
    path: Path,
    directory: Path,
    *,
    laws: Mapping[str, TunedLaw],
    tasks: Sequence[str] = (),
    table: Path | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> BenchmarkResult:
    """Tune and judge laws on the tasks of a benchmark.

    Args:
        benchmark: see ``load_benchmark``.
        path: of its file.
        directory: new or empty, or to resume.
        laws: see ``laws_of``.
        tasks: only these; none: all.
        table: of results, to enter the rows in; None: one in the directory. A new one begins with what is shipped.
        workers: local processes; None: one per core. They change no number.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of an evaluation; ten times as much may elapse.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the input cannot be used as it is, and nothing was written; or no evaluation came to a number.
    """
    hooks, place = hooks or StudyHooks(), table or directory / TABLE
    check_place(directory, "a new or empty directory, or one to resume")
    wanted = {chosen(task, benchmark.tasks, "--task"): task for task in tasks} or dict.fromkeys(benchmark.tasks)
    results = first_table(place, path, benchmark)
    tunings: dict[str, Tuning] = {task: benchmark.tuning(task, laws, path) for task in wanted}
    for task, tuning in tunings.items():
        check_directory(directory / task, tuning, resume=resume)
    passed = True
    for task, tuning in tunings.items():
        done = run_tuning(tuning, directory / task, workers=workers, resume=resume, time_limit=time_limit, hooks=hooks)
        if done.end_reason != "completed":
            return BenchmarkResult(directory, done.end_reason, results, False)
        passed = passed and done.passed
        results = results.with_rows([row_of(task, tuning, stand) for stand in done.stands])
        results.write(place)
    return BenchmarkResult(directory, "completed", results, passed)
