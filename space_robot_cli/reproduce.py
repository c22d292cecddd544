"""What ``space-robot reproduce`` does between its options and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from space_robot_cli.render.paper import show
from space_robot_cli.render.paper_page import write_markdown
from space_robot_cli.study import announce, print_interrupted, study
from space_robot_cli.study_options import StudyOptions
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install
from space_robot_studies.reproduce.plan import Plan, choose_figures, load_plan
from space_robot_studies.reproduce.reproduction import reproduce


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command.

    Attributes:
        paper: name or manifest file.
        study: of all runs.
        figures: which; none: all.
        directory: of the report; None: ``out/<paper>``.
    """

    paper: str
    study: StudyOptions
    figures: tuple[str, ...] = ()
    directory: Path | None = None


def run(options: Options, out: Console, err: Console) -> bool:
    """Check, run, draw, judge and print.

    Returns:
        Whether everything is as documented; False if it was interrupted.

    Raises:
        SpaceRobotError: something is wrong with the input; nothing was written.
    """
    try:
        from space_robot_report.figures.paper import check_colors
        from space_robot_report.pages.paper_report import PAGE, write_report
    except ImportError as error:
        needs = f"reproduce needs matplotlib and jinja2 ({error})"
        raise SpecError(needs, accepted=install("viz")) from None
    with study(err, quiet=options.study.as_json) as hooks:
        plan = load_plan(options.paper)
        figures = choose_figures(plan.manifest, options.figures)
        for name in figures:
            check_colors(plan.manifest.figures[name], f"{plan.argument} figures.{name}")
        options.study.check_markdown()
        if not options.study.as_json:
            announce(err, _laws(plan, figures))
        directory = options.directory or Path("out") / plan.name
        result = reproduce(
            plan,
            directory,
            figures=figures,
            workers=options.study.workers,
            resume=options.study.resume,
            time_limit=options.study.seconds,
            hooks=hooks,
        )
        if result.end_reason != "completed":
            print_interrupted(err, result.end_reason)
            return False
        data = write_report(plan, result.figures, directory)
        if options.study.markdown is not None:
            write_markdown(options.study.markdown, data)
    if options.study.as_json:
        print(json.dumps(data, allow_nan=False))
    else:
        show(out, data)
        out.print(f"page: {directory / PAGE}", markup=False, soft_wrap=True)
    return result.passed


def _laws(plan: Plan, figures: list[str]) -> list[str]:
    return [name for run in plan.distinct_runs(figures).values() for name in run.experiment.controller.law_names]
