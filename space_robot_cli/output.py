"""Where commands print: rich is loaded for tables, styles and terminals; a line into a pipe or a file needs none."""

from __future__ import annotations

import os
import sys
from functools import cached_property
from typing import TYPE_CHECKING, Any, TextIO

from space_robot_msgs_py.escapes import visible

if TYPE_CHECKING:
    from space_robot_cli.terminal import PlainConsole

# With one of these rich may take a pipe for a terminal.
_FORCING = ("FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "JUPYTER_COLUMNS", "JUPYTER_LINES")
# What a line may be printed with and still be a line: a style is nothing where there are no colors.
_LINE = {"markup": False, "soft_wrap": True}


class Output:
    """A ``PlainConsole`` that is made by the first print that needs it; what it prints is the same to the byte.

    Args:
        stderr: of the two streams of the process, this one.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        self._stderr = stderr

    @cached_property
    def console(self) -> PlainConsole:
        """The console."""
        from space_robot_cli.terminal import PlainConsole

        # A pipe has no width of its own; 80 columns would cut numbers.
        width = None if self._stderr or sys.stdout.isatty() else 120
        return PlainConsole(stderr=self._stderr, width=width)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print as ``Console.print`` does."""
        stream = sys.stderr if self._stderr else sys.stdout
        options_of_line = {key: value for key, value in options.items() if key != "style"}
        if len(objects) == 1 and options_of_line == _LINE and _is_line(objects[0], stream):
            stream.write(f"{visible(objects[0])}\n")
            stream.flush()
        else:
            self.console.print(*objects, **options)

    def __getattr__(self, name: str) -> Any:
        """Everything else is that of the console."""
        return getattr(self.console, name)

    def __enter__(self) -> Any:
        return self.console.__enter__()

    def __exit__(self, *error: Any) -> None:
        self.console.__exit__(*error)


def _is_line(text: Any, stream: TextIO) -> bool:
    """Whether rich would write just this text: it expands tabs, and some of its releases strip the ends of lines."""
    return (
        type(text) is str
        and "\t" not in text
        and all(line and line == line.rstrip() for line in text.split("\n"))
        and (text.isascii() or (stream.encoding or "").lower() in ("utf-8", "utf8"))
        and not stream.isatty()
        and not any(name in os.environ for name in _FORCING)
    )
