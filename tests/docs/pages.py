"""The pages of the repository and what they put between back-ticks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
TOP = ("README.md", "CONTRIBUTING.md", "SECURITY.md")
FENCE = re.compile(r"^ *```.*?^ *```", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"(?<!`)`([^`]+)`(?!`)")
PARAGRAPH = re.compile(r"\n\s*\n")


@dataclass(frozen=True, slots=True)
class Span:
    """What stands between two back-ticks.

    Attributes:
        page: path from the root of the repository.
        line: where it starts, from 1.
        text: with line breaks as spaces.
        before: the spans before it in the same paragraph, the nearest first.
    """

    page: str
    line: int
    text: str
    before: tuple[str, ...]

    @property
    def place(self) -> str:
        """``page:line``, as editors take it."""
        return f"{self.page}:{self.line}"


def pages() -> list[Path]:
    """README, CONTRIBUTING, SECURITY and everything in docs/."""
    return [*(ROOT / name for name in TOP), *sorted((ROOT / "docs").rglob("*.md"))]


def spans(page: str, text: str) -> Iterator[Span]:
    """Every code span of a page outside fenced blocks (whose commands and files other tests try)."""
    text = FENCE.sub(lambda block: "\n" * block.group().count("\n"), text)
    start = 0
    for end in (*(gap.start() for gap in PARAGRAPH.finditer(text)), len(text)):
        before: tuple[str, ...] = ()
        for found in SPAN.finditer(text, start, end):
            words = " ".join(found.group(1).split())
            yield Span(page, text.count("\n", 0, found.start()) + 1, words, before)
            before = (words, *before)
        start = end
