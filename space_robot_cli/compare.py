"""What ``space-robot compare`` does between its options and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from space_robot_cli.render.comparison import show
from space_robot_cli.study import announce, print_interrupted, study
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError, SpecError
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.compare.compare import ComparisonResult, compare, load_compared
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.compare.tables import markdown
from space_robot_studies.engine.tasks import TIME_LIMIT


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command.

    Attributes:
        campaigns: names or files.
        directory: of the comparison.
        runs: per point of the grid; None: what the files say.
        workers: processes; None: one per core.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of a run; None: the default.
        metrics: which tables are printed; none: all.
        markdown: where all tables go; None: nowhere.
        as_json: print numbers and nothing else on stdout.
    """

    campaigns: tuple[str, ...]
    directory: Path
    runs: int | None = None
    workers: int | None = None
    resume: bool = False
    time_limit: float | None = None
    metrics: tuple[str, ...] = ()
    markdown: Path | None = None
    as_json: bool = False


def run(options: Options, out: Console, err: Console) -> bool:
    """Check, run, put side by side, draw and print.

    Args:
        options: of the command.
        out: stdout.
        err: stderr, for progress.

    Returns:
        Whether all was run and every bound of the campaigns holds. A law that fails is a row, not a failure.

    Raises:
        SpaceRobotError: something is wrong with the input.
    """
    for metric in options.metrics:
        if metric not in METRICS:
            raise SpecError("no such metric", key="--metric", value=metric, accepted=", ".join(METRICS))
    if options.markdown is not None and not is_directory(options.markdown.resolve().parent):
        raise InputFileError("no such folder", key="--markdown", value=short(options.markdown))
    with study(err, quiet=options.as_json) as hooks:
        if not options.as_json:
            announce(err, _laws(options))
        result = compare(
            options.campaigns,
            options.directory,
            runs=options.runs,
            workers=options.workers,
            resume=options.resume,
            time_limit=TIME_LIMIT if options.time_limit is None else options.time_limit,
            hooks=hooks,
        )
        if result.costs is None:
            print_interrupted(err, result.end_reason)
            return False
        _write(options, result)
    if options.as_json:
        print(json.dumps(result.to_dict() | {"costs_us": result.costs}, allow_nan=False))
        return result.passed
    for comparison in result.comparisons:
        show(out, comparison, result.costs[comparison.name], options.metrics or tuple(METRICS))
    out.print(f"numbers and pictures: {options.directory}", markup=False, soft_wrap=True)
    return result.passed


def _laws(options: Options) -> list[str]:
    return [
        make_case(campaign, index).data["controller"]["law"]
        for campaign in load_compared(options.campaigns, options.runs).values()
        for index in range(campaign.points)
    ]


def _write(options: Options, result: ComparisonResult) -> None:
    """Pictures where matplotlib is, and the tables where a file for them is given."""
    if options.markdown is not None:
        write_atomically(options.markdown, markdown(result.comparisons, result.costs or {}))
    try:
        from space_robot_report.figures.comparison import draw_comparison
    except ImportError:
        return
    for comparison in result.comparisons:
        draw_comparison(comparison, options.directory / f"{comparison.name}.png")
