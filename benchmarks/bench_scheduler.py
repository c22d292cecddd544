"""The machinery of a large campaign without its runs: 100,000 trivial cases through a Dask scheduler into a journal."""

from __future__ import annotations

import resource
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from space_robot_studies.engine.groups import Grouping, run_in_groups
from space_robot_studies.engine.journal import ROWS, Row, locked, open_journal
from space_robot_studies.engine.tasks import Lost, Task

CASES, WORKERS, LIMIT = 100_000, 2, 300.0
# What a case of `giordano2023/sec5` has: as many columns, and the experiment with its robot as the argument.
COLUMNS, ARGUMENT = 75, "x" * 9_000


def trivial(index: int, argument: str) -> dict[str, Any]:
    """The columns of a run that takes no time."""
    return {f"metric_{column}.final_error": (index + column) / 7.0 for column in range(COLUMNS)}


def trivial_together(cases: Sequence[tuple[int, str]]) -> list[dict[str, Any] | None]:
    """Of several."""
    return [trivial(*case) for case in cases]


def run() -> dict[str, float]:
    """Cases per second and their cost, with and without groups; a fiftieth of the cases without."""
    from distributed import Client, LocalCluster

    table: dict[str, float] = {}
    options = {"dashboard_address": None, "scheduler_kwargs": {"dashboard": False}}
    with LocalCluster(WORKERS, threads_per_worker=1, processes=True, **options) as cluster, Client(cluster) as client:
        for name, cases, grouped in (("in groups", CASES, True), ("one by one", CASES // 50, False)):
            table |= {
                f"{cases} trivial cases {name}: {what}": value for what, value in _one(client, cases, grouped).items()
            }
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return table | {f"after {CASES} rows, largest size of the process that keeps them: MB": peak}


def _one(client: Any, cases: int, grouped: bool) -> dict[str, float]:
    from space_robot_studies.engine.dask_workers import DaskWorkers

    def tasks() -> Iterator[Task[dict[str, Any]]]:
        for index in range(cases):
            yield Task(index, trivial, (index, ARGUMENT))

    def kind(task: Task[dict[str, Any]]) -> str | None:
        return "all" if grouped else None

    pool, grouping = DaskWorkers(client, LIMIT), Grouping(kind, trivial_together)
    with tempfile.TemporaryDirectory() as scratch, locked(Path(scratch)):
        wall, cpu = perf_counter(), process_time()
        with open_journal(Path(scratch), {}, LIMIT) as journal:
            for task, outcome in run_in_groups(pool, tasks(), cases, grouping, lambda: None):
                assert not isinstance(outcome, Lost)
                journal.append(Row(int(task.key), outcome))
        wall, cpu = perf_counter() - wall, process_time() - cpu
        size = (Path(scratch) / ROWS).stat().st_size
    return {
        "cases per s": cases / wall,
        "CPU of campaign and client per case: us": 1e6 * cpu / cases,
        "bytes of the journal per case": size / cases,
    }
