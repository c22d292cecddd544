"""Text of third parties stays text, whatever shows it."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.table import Table

from space_robot_cli.terminal import PlainConsole, markup
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.escapes import html, mathtext, plotly, visible

ESCAPE_SEQUENCES = {
    "colors": "\x1b[31mred\x1b[0m",
    "the title of the window": "\x1b]0;owned\x07",
    "the line before": "fine\r\x1b[1A\x1b[2KPASS",
    "C1": "\x9b31mred",
    "backspace": "FAIL\b\b\b\bPASS",
    "right to left": "\u202etxt.exe",
    "half a character": "\udc80",
    "NUL": "a\0b",
}


@pytest.mark.parametrize("text", ESCAPE_SEQUENCES.values(), ids=ESCAPE_SEQUENCES)
def test_control_characters_are_escaped_for_a_terminal(text: str) -> None:
    """Control characters are shown as their codes, and every stream can write the result."""
    shown = visible(text)
    assert all(character.isprintable() for character in shown)
    shown.encode("utf-8")


@given(st.text())
def test_printable_text_is_not_changed(text: str) -> None:
    """A text of printable characters is not changed, and showing it twice is showing it once."""
    plain = "".join(character for character in text if character.isprintable())
    assert visible(plain) == plain
    assert visible(visible(text)) == visible(text)


@given(st.text())
def test_html_has_no_element_of_a_text(text: str) -> None:
    """No tag, attribute or entity begins in a text, for pages and for the labels of plots."""
    assert not set(html(text)) & set("<>\"'")
    assert not set(plotly(text)) & set("<>")


@pytest.mark.parametrize("text", ["$x$", "$\\frac$", "$", "a$b$c$d", "\\$x$", "_hidden", "\x1b$y$"])
def test_matplotlib_draws_a_text_and_no_formula(text: str, tmp_path: Path) -> None:
    """Dollars are drawn as dollars, a formula that is none raises nothing, and a leading underscore hides nothing."""
    pytest.importorskip("matplotlib")
    from matplotlib.cbook import is_math_text

    from space_robot_report.figures.pictures import plt

    shown = mathtext(text)
    assert not is_math_text(shown)
    figure, axis = plt.subplots()
    try:
        axis.plot([0, 1], [0, 1], label=shown)
        legend = axis.legend()
        assert [one.get_text() for one in legend.get_texts()] == [shown]
        figure.savefig(tmp_path / "picture.svg")
    finally:
        plt.close(figure)


def test_a_console_obeys_no_text() -> None:
    """Titles and cells of tables, with and without markup, print brackets, codes and escapes as they are."""
    out = StringIO()
    console = PlainConsole(file=out, width=200, force_terminal=False)
    hostile = "[red]\x1b[31m [/] :smile: [link=file:///etc/passwd]x"
    table = Table(title=markup(hostile))
    table.add_column(markup(hostile))
    table.add_row(markup(hostile))
    console.print(table)
    console.print(hostile, markup=False)
    said = out.getvalue()
    assert "\x1b" not in said
    assert said.count("[red]\\x1b[31m [/] :smile: [link=file:///etc/passwd]x") == 4


def test_an_error_is_one_line_that_steers_nothing() -> None:
    """Whatever an error quotes, it is one line of printable text of bounded length."""
    line = str(SpecError("a\x1b[31mb\nc", key="k\r", value=10**6000, accepted="x" * 10**6))
    assert line.isprintable()
    assert len(line) < 10_000
    assert isinstance(SpecError("x"), SpaceRobotError)
