"""The page of speed: its tables are written by the benchmarks."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks.__main__ import NAMES
from benchmarks.machine import described
from benchmarks.page import END, begin, block, with_block, write_table
from tests.support.paths import ROOT


def test_a_table_replaces_the_one_of_its_benchmark_and_nothing_else(tmp_path: Path) -> None:
    """A new one comes last, the same one changes nothing, another one stays."""
    page = tmp_path / "page.md"
    page.write_text("# Speed\n\nWords.\n", encoding="utf-8")
    write_table(page, "log", {"messages/s": 1234.5}, "a machine")
    write_table(page, "start", {"list": 2.0}, "a machine")
    first = page.read_text(encoding="utf-8")
    assert first.startswith("# Speed\n\nWords.\n\n<!-- python -m benchmarks log -->\n`log` on a machine:\n")
    assert "| messages/s | 1234 |" in first
    write_table(page, "log", {"messages/s": 99.0}, "another")
    second = page.read_text(encoding="utf-8")
    assert second == first.replace("1234", "99").replace("`log` on a machine", "`log` on another")
    assert with_block(second, "start", block("start", {"list": 2.0}, "a machine")) == second


def test_the_page_has_whole_tables_of_benchmarks_there_are() -> None:
    """Each begins with its benchmark and ends; a machine is described in each."""
    page = (ROOT / "docs" / "speed.md").read_text(encoding="utf-8")
    names = re.findall(r"<!-- python -m benchmarks (\w+) -->", page)
    assert names
    assert set(names) <= set(NAMES)
    assert page.count(END) == len(names)
    for name in names:
        assert re.search(rf"{re.escape(begin(name))}\n`{name}` on .+CPython .+:\n", page)


def test_a_machine_is_described_in_a_line() -> None:
    """Processor, cores, interpreter and load."""
    text = described()
    assert "\n" not in text
    assert re.search(r"\d+ cores, \w+, CPython 3\.\d+.*; \d+\.\d processes wanted to run beside it$", text)
