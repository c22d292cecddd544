"""What ``space-robot compare`` does between its options and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from space_robot_cli.render.comparison import show
from space_robot_cli.study import announce, print_interrupted, study
from space_robot_cli.study_options import StudyOptions
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.compare.compare import ComparisonResult, compare, load_compared
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.compare.tables import markdown


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command.

    Attributes:
        campaigns: names or files.
        directory: of the comparison.
        study: of all runs.
        runs: per point of the grid; None: what the files say.
        metrics: which tables are printed; none: all.
    """

    campaigns: tuple[str, ...]
    directory: Path
    study: StudyOptions
    runs: int | None = None
    metrics: tuple[str, ...] = ()


def run(options: Options, out: Console, err: Console) -> bool:
    """Check, run, put side by side, draw and print.

    Returns:
        Whether all was run and every bound of the campaigns holds. A law that fails is a row, not a failure.

    Raises:
        SpaceRobotError: something is wrong with the input.
    """
    for metric in options.metrics:
        if metric not in METRICS:
            raise SpecError("no such metric", key="--metric", value=metric, accepted=", ".join(METRICS))
    options.study.check_markdown()
    with study(err, quiet=options.study.as_json) as hooks:
        if not options.study.as_json:
            announce(err, _laws(options))
        result = compare(
            options.campaigns,
            options.directory,
            runs=options.runs,
            workers=options.study.workers,
            resume=options.study.resume,
            time_limit=options.study.seconds,
            hooks=hooks,
        )
        if result.costs is None:
            print_interrupted(err, result.end_reason)
            return False
        _write(options, result)
    if options.study.as_json:
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
    if options.study.markdown is not None:
        write_atomically(options.study.markdown, markdown(result.comparisons, result.costs or {}))
    try:
        from space_robot_report.figures.comparison import draw_comparison
    except ImportError:
        return
    for comparison in result.comparisons:
        draw_comparison(comparison, options.directory / f"{comparison.name}.png")
