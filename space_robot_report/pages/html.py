"""Templates of pages that need no server and no other file."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from space_robot_msgs_py.escapes import visible

HERE = Path(__file__).parent
# A page needs nothing from anywhere: whatever got into it, it loads nothing and sends nothing.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; font-src data:; "
    "form-action 'none'; base-uri 'none'"
)


def environment() -> Environment:
    """The templates of this package; a name they do not know is an error."""
    found = Environment(
        loader=FileSystemLoader(HERE),
        autoescape=True,
        finalize=_plain,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["number"] = number
    found.globals["style"] = script("style.css")
    found.globals["policy"] = POLICY
    return found


def _plain(value: object) -> object:
    """Of a text that is not this page's own HTML, only what can be seen; jinja escapes the rest."""
    return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def script(name: str) -> Markup:
    """A file of this package, as it is."""
    return Markup((HERE / name).read_text(encoding="utf-8"))


def number(value: float | None) -> str:
    """A number for a table; a dash where there is none."""
    if value is None:
        return "–"
    return f"{value:.3g}" if value == 0.0 or abs(value) >= 1e-3 else f"{value:.0e}"
