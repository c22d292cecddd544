"""The files a reproduction leaves: pictures, the page, claims.json."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from pathlib import Path

from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_report.figures.paper import draw_figure
from space_robot_report.pages.html import environment
from space_robot_studies.reproduce.plan import Plan, picture_name
from space_robot_studies.reproduce.reproduction import CLAIMS, FigureResult
from space_robot_studies.reproduce.summary import Data, count, heading, sample, summary

PAGE = "index.html"


def write_report(plan: Plan, result: Sequence[FigureResult], directory: Path) -> Data:
    """Draw and write everything.

    Args:
        plan: of the paper.
        result: its figures.
        directory: where to.

    Returns:
        What is in claims.json.

    Raises:
        LogError: something cannot be written.
    """
    pictures: dict[str, str] = {}
    for figure in result:
        file = picture_name(figure.name)
        if draw_figure(figure, directory / file):
            pictures[figure.name] = file
    data = summary(plan, result, pictures)
    write_atomically(directory / PAGE, page(data, directory))
    write_atomically(directory / CLAIMS, json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n")
    return data


TEMPLATE = "page.html.j2"


def page(data: Data, folder: Path) -> str:
    """The page as HTML.

    Args:
        data: see ``summary``.
        folder: where its pictures are; they become part of the page.
    """
    templates = environment()
    pictures = {
        figure["name"]: base64.b64encode((folder / figure["picture"]).read_bytes()).decode()
        for figure in data["figures"]
        if figure["picture"]
    }
    filters = {"digits": lambda value, digits: f"{value:.{digits}g}", "heading": heading, "sample": sample}
    templates.filters.update(filters)
    return templates.get_template(TEMPLATE).render(paper=data, pictures=pictures, count=count(data))
