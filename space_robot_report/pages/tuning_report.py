"""The page of a tuning: what was gained and is it real, then law by law the search, the front and the neighbours."""

from __future__ import annotations

import base64
from pathlib import Path

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_report.figures.tuning import picture_of
from space_robot_report.pages.html import environment
from space_robot_studies.tune.outcome import TuningResult
from space_robot_studies.tune.tables import HEADINGS, LEGEND, rows_of

PAGE, TEMPLATE = "index.html", "tuning.html.j2"


def write_page(result: TuningResult, title: str) -> Path:
    """Write the page into the directory of the tuning.

    Args:
        result: of a tuning that came to its end.
        title: of the file.

    Returns:
        The page.

    Raises:
        LogError: it cannot be written.
    """
    path = result.directory / PAGE
    write_atomically(path, page(result, title))
    return path


def page(result: TuningResult, title: str) -> str:
    """The page as HTML; it needs no other file."""
    stands = [
        {
            "where": stand.where,
            "picture": base64.b64encode(picture_of(stand)).decode(),
            "section": dump_yaml(stand.controller),
            "ranges": {name: f"{one.low:g} to {one.high:g}, {one.scale}" for name, one in stand.ranges.items()},
            "evaluations": len(stand.evaluations),
        }
        for stand in result.stands
    ]
    template = environment().get_template(TEMPLATE)
    return template.render(title=title, headings=HEADINGS, rows=rows_of(result), legend=LEGEND, stands=stands)
