"""The files a reproduction leaves: pictures, the page, claims.json."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from space_robot_bringup.report.page import page
from space_robot_bringup.report.paper_figure import draw_figure
from space_robot_bringup.reproduce.plan import Plan, picture_name
from space_robot_bringup.reproduce.reproduction import CLAIMS, FlownFigure
from space_robot_bringup.reproduce.summary import Data, summary
from space_robot_msgs_py.atomic_file import write_atomically

PAGE = "index.html"


def write_report(plan: Plan, flown: Sequence[FlownFigure], directory: Path) -> Data:
    """Draw and write everything.

    Args:
        plan: of the paper.
        flown: its figures.
        directory: where to.

    Returns:
        What is in claims.json.

    Raises:
        LogError: something cannot be written.
    """
    pictures: dict[str, str] = {}
    for figure in flown:
        file = picture_name(figure.name)
        if draw_figure(figure, directory / file):
            pictures[figure.name] = file
    data = summary(plan, flown, pictures)
    write_atomically(directory / PAGE, page(data, directory))
    write_atomically(directory / CLAIMS, json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n")
    return data
