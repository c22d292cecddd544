"""The terminal: text of third parties cannot steer it, whether it is printed as it is or with markup beside it."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.text import Text

from space_robot_msgs_py.escapes import visible


class PlainConsole(Console):
    """A console that shows control characters instead of obeying them, whatever prints; texts have no emoji codes."""

    def __init__(self, **options: Any) -> None:
        super().__init__(emoji=False, highlight=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Every text that is printed comes through here, cells of tables too."""
        return super().render_str(visible(text), **options)


def markup(text: str) -> str:
    """A text for a cell or title of a table, where square brackets are markup."""
    return escape(visible(text))
