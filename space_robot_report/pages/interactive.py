"""Pages with plots one can turn to and fro: plotly.js and everything drawn in one text."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup
from plotly.offline import get_plotlyjs

from space_robot_report.pages.html import environment, script
from space_robot_report.pages.plots import Plot


class PlotBook:
    """The plots of a page: each gets a number, by which the template places it."""

    def __init__(self) -> None:
        self._figures: list[dict[str, Any]] = []

    def add(self, plot: Plot) -> dict[str, Any]:
        """What the template needs of a plot."""
        return self.add_raw(plot.to_plotly(), plot.title, plot.note)

    def add_raw(self, figure: dict[str, Any], title: str, note: str = "") -> dict[str, Any]:
        """The same for a figure of plotly's own kind."""
        self._figures.append(figure)
        return {"index": len(self._figures) - 1, "title": title, "note": note}

    def all(self, plots: Sequence[Plot]) -> list[dict[str, Any]]:
        """Several at once."""
        return [self.add(plot) for plot in plots]

    def json(self) -> Markup:
        """Every figure."""
        return embedded(self._figures)


def interactive_page(template: str, book: PlotBook, content: Mapping[str, Any]) -> str:
    """A page with plots.

    Args:
        template: which extends ``base.html.j2``.
        book: its plots.
        content: what else the template knows.
    """
    scripts = {"plotly": Markup(get_plotlyjs()), "plots": book.json(), "plots_script": script("plots.js")}
    return environment().get_template(template).render(**content, **scripts)


def embedded(data: object) -> Markup:
    """Data as JSON inside a script element, which no text of the data can close."""
    return Markup(json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"))
