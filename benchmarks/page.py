"""Tables on a page: the benchmark writes its own, between two comments, and leaves the rest as it is."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

END = "<!-- end -->"


def begin(name: str) -> str:
    """The comment that a benchmark's table stands behind."""
    return f"<!-- python -m benchmarks {name} -->"


def block(name: str, rows: Mapping[str, float], machine: str) -> str:
    """The table of a benchmark.

    Args:
        name: of the benchmark.
        rows: what was measured, and the number.
        machine: what it was measured on.
    """
    lines = [begin(name), f"`{name}` on {machine}:", "", "| what | |", "|---|---|"]
    lines += [f"| {row} | {value:.4g} |" for row, value in rows.items()]
    return "\n".join([*lines, "", END])


def with_block(page: str, name: str, table: str) -> str:
    """The page with the table of a benchmark in place of the one it has, else at its end."""
    start = page.find(begin(name))
    if start < 0:
        return f"{page.rstrip()}\n\n{table}\n"
    stop = page.index(END, start) + len(END)
    return page[:start] + table + page[stop:]


def write_table(path: Path, name: str, rows: Mapping[str, float], machine: str) -> None:
    """Put the table of a benchmark on a page."""
    page = path.read_text(encoding="utf-8")
    path.write_text(with_block(page, name, block(name, rows, machine)), encoding="utf-8")
