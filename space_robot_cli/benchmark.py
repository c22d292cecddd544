"""What ``space-robot benchmark`` does between its options and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as Grid

from space_robot_cli.study import announce, print_interrupted, study
from space_robot_cli.study_options import StudyOptions
from space_robot_cli.terminal import markup
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.benchmark.page import HEADINGS, LEGEND, cells_of, page_of, points_of, sentence, standings
from space_robot_studies.benchmark.ranking import rank
from space_robot_studies.benchmark.run import BenchmarkResult, laws_of, run_benchmark
from space_robot_studies.benchmark.spec import Benchmark, benchmark_path, load_benchmark
from space_robot_studies.compare.tables import words


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command.

    Attributes:
        file: shipped name or path.
        directory: of the searches.
        study: of all runs.
        laws: only these of the file, or custom ones; none: all of the file.
        tasks: only these; none: all.
        only: ``KEY=LABEL``, only these points.
        short: the part of the file that is over in minutes.
        table: file of results to enter the rows in; None: one in the directory.
    """

    file: str
    directory: Path
    study: StudyOptions
    laws: tuple[str, ...] = ()
    tasks: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    short: bool = False
    table: Path | None = None


def run(options: Options, out: Console, err: Console) -> bool:
    """Check, tune, judge, enter the rows and print.

    Returns:
        Whether it came to its end and every law has gains that keep the constraints.

    Raises:
        SpaceRobotError: something is wrong with the input.
    """
    options.study.check_markdown()
    benchmark = load_benchmark(options.file, short=options.short, only=options.only)
    laws = laws_of(benchmark, options.laws, Path.cwd())
    with study(err, quiet=options.study.as_json) as hooks:
        if not options.study.as_json:
            announce(err, [law.law or name for name, law in laws.items()])
        result = run_benchmark(
            benchmark,
            benchmark_path(options.file),
            options.directory,
            laws=laws,
            tasks=options.tasks,
            table=options.table,
            workers=options.study.workers,
            resume=options.study.resume,
            time_limit=options.study.seconds,
            hooks=hooks,
        )
    if result.end_reason != "completed":
        print_interrupted(err, result.end_reason)
        return False
    titles = {name: task.title for name, task in benchmark.tasks.items()}
    if options.study.markdown is not None:
        write_atomically(options.study.markdown, page_of(result.table, titles))
    if options.study.as_json:
        print(json.dumps(result.table.to_dict(), allow_nan=False))
    else:
        _show(out, result, benchmark)
    return result.passed


def _show(out: Console, result: BenchmarkResult, benchmark: Benchmark) -> None:
    for task in benchmark.tasks:
        for rows in points_of(result.table, task):
            title = ", ".join(part for part in (benchmark.tasks[task].title or task, words(rows[0]["point"])) if part)
            grid = Grid(box=SIMPLE_HEAD, title=markup(title), title_justify="left")
            for place, heading in enumerate(HEADINGS):
                grid.add_column(heading, justify="right" if place else "left", no_wrap=not place)
            for row in cells_of(rows):
                grid.add_row(*map(markup, row))
            out.print(grid)
            out.print(sentence(rank(standings(rows))), markup=False, soft_wrap=True)
    out.print(LEGEND, markup=False, soft_wrap=True)
    out.print(f"searches: {result.directory}", markup=False, soft_wrap=True)
