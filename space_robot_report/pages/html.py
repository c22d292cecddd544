"""Templates of pages that need no server and no other file."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

HERE = Path(__file__).parent


def environment() -> Environment:
    """The templates of this package; a name they do not know is an error."""
    found = Environment(
        loader=FileSystemLoader(HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["number"] = number
    found.globals["style"] = script("style.css")
    return found


def script(name: str) -> Markup:
    """A file of this package, as it is."""
    return Markup((HERE / name).read_text(encoding="utf-8"))


def number(value: float | None) -> str:
    """A number for a table; a dash where there is none."""
    if value is None:
        return "–"
    return f"{value:.3g}" if value == 0.0 or abs(value) >= 1e-3 else f"{value:.0e}"
