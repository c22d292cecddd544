"""What ``space-robot tune`` does between its options and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.study import announce, print_interrupted, study
from space_robot_cli.study_options import StudyOptions
from space_robot_cli.terminal import markup
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.tune.outcome import TuningResult
from space_robot_studies.tune.spec import load_tuning, tuning_path
from space_robot_studies.tune.tables import HEADINGS, LEGEND, markdown, rows_of
from space_robot_studies.tune.tune import run_tuning


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command.

    Attributes:
        file: shipped name or path.
        study: of all runs.
        laws: only these; none: all of the file.
        budget: evaluations per law and point; None: what the file says.
        directory: None: ``runs/<name>``.
    """

    file: str
    study: StudyOptions
    laws: tuple[str, ...] = ()
    budget: int | None = None
    directory: Path | None = None


def run(options: Options, out: Console, err: Console) -> bool:
    """Check, search, draw and print.

    Returns:
        Whether it came to its end and every law has gains that keep the constraints.

    Raises:
        SpaceRobotError: something is wrong with the input.
    """
    options.study.check_markdown()
    tuning = load_tuning(options.file, laws=options.laws, budget=options.budget)
    with study(err, quiet=options.study.as_json) as hooks:
        if not options.study.as_json:
            announce(err, [law.law for law in tuning.laws.values()])
        result = run_tuning(
            tuning,
            options.directory or Path("runs") / tuning_path(options.file).stem,
            workers=options.study.workers,
            resume=options.study.resume,
            time_limit=options.study.seconds,
            hooks=hooks,
        )
    if result.end_reason != "completed":
        print_interrupted(err, result.end_reason)
        return False
    _write(options, result, tuning.title)
    if options.study.as_json:
        print(json.dumps(result.to_dict(), allow_nan=False))
    else:
        _show(out, result, tuning.title)
    return result.passed


def _write(options: Options, result: TuningResult, title: str) -> None:
    """The page where the libraries for it are, and the tables where a file for them is given."""
    if options.study.markdown is not None:
        write_atomically(options.study.markdown, markdown(result))
    try:
        from space_robot_report.pages.tuning_report import write_page
    except ImportError:
        return
    write_page(result, title)


def _show(out: Console, result: TuningResult, title: str) -> None:
    table = Table(box=SIMPLE_HEAD, title=markup(title), title_justify="left")
    for place, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if place else "left")
    for row in rows_of(result):
        table.add_row(*map(markup, row))
    out.print(table)
    for stand in result.stands:
        if stand.overrides:
            out.print(f"{stand.where}: {stand.overrides}", markup=False, soft_wrap=True)
    out.print(LEGEND, markup=False, soft_wrap=True)
    out.print(f"gains to paste, all evaluations and pictures: {result.directory}", markup=False, soft_wrap=True)
