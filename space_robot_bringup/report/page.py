"""A reproduction as one page that needs no server and no other file."""

from __future__ import annotations

import base64
from pathlib import Path

from space_robot_bringup.report.html import environment
from space_robot_bringup.reproduce.show import count, heading, sample
from space_robot_bringup.reproduce.summary import Data

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
