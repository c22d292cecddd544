"""What is printed without rich is what rich prints, to the byte."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_cli.output import Output
from space_robot_cli.terminal import PlainConsole

TEXTS = (
    "fine. servicer, 7 joints",
    "  indented, [brackets] and [red]markup[/red], :smile: and a\\backslash",
    "long " * 60 + "end",
    "two\nlines",
    "an end \nwith a space ",
    "a\ttab",
    "",
    "ends\n",
    "\n",
    "controls \x1b[31m \x07 and \u202e turned",
    "ö, 漢字 and 🛰",
    "1 of 3 at 12:30, None, True, http://example.org",
)


@pytest.mark.parametrize("stderr", [False, True])
@pytest.mark.parametrize("options", [{}, {"style": "red"}, {"style": "bold"}])
def test_a_line_is_the_same_with_and_without_rich(
    stderr: bool, options: dict[str, Any], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also with what rich expands, strips or refuses to obey; where colors are forced there are colors."""
    for forced in ("", "1"):
        if forced:
            monkeypatch.setenv("FORCE_COLOR", forced)
        said = []
        for console in (Output(stderr=stderr), PlainConsole(stderr=stderr, width=None if stderr else 120)):
            for text in TEXTS:
                console.print(text, markup=False, soft_wrap=True, **options)
            said.append(capsys.readouterr())
        assert said[0] == said[1]
        assert (said[0].err if stderr else said[0].out).count("\n") > len(TEXTS)


def test_tables_and_whatever_else_a_console_does_are_those_of_rich(capsys: pytest.CaptureFixture[str]) -> None:
    """Its attributes are there, it can be entered, and what is no line goes through it."""
    out = Output()
    with out:
        out.print("[bold]markup[/bold]", 3)
    assert (out.width, capsys.readouterr().out) == (120, "markup 3\n")
