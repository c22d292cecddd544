"""Results of a shipped benchmark on pages: ``python -m space_robot_studies.benchmark.docs FILE ...``.

A page has ``<!-- results of NAME -->``, or ``in brief``, ``in short``, ``at a glance`` or ``by knowledge`` behind the
name, and ``<!-- end -->`` where they end.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.benchmark.digest import brief_of, digest_of
from space_robot_studies.benchmark.knowledge import knowledge_of
from space_robot_studies.benchmark.overview import overview_of
from space_robot_studies.benchmark.page import page_of
from space_robot_studies.benchmark.spec import Benchmark, benchmark_path, load_benchmark
from space_robot_studies.benchmark.table import Table, read_table
from space_robot_studies.campaign.variation import count_points

MARKED = re.compile(r"(<!-- results of (\S+?)(?: ([a-z ]+))? -->\n).*?(<!-- end -->)", re.DOTALL)
FORMS: dict[str | None, Callable[[Table, Mapping[str, str]], str]] = {
    None: page_of,
    "in brief": brief_of,
    "in short": digest_of,
    "at a glance": overview_of,
    "by knowledge": knowledge_of,
}

# What speaks of all points says how many of them are measured.
WHOLE = ("in short", "at a glance")


def filled(text: str) -> str:
    """A page with the results of the shipped tables in their places.

    Raises:
        SpaceRobotError: a page names a benchmark that is not shipped.
    """

    def results(found: re.Match[str]) -> str:
        benchmark = load_benchmark(found[2])
        table = read_table(benchmark_path(found[2]).with_suffix(".json"), benchmark)
        titles = {name: task.title for name, task in benchmark.tasks.items()}
        said = FORMS[found[3]](table, titles)
        head = f"{measured(table, benchmark)}\n\n" if found[3] in WHOLE else ""
        return f"{found[1]}\n{head}{said}\n{found[4]}"

    return MARKED.sub(results, text)


def measured(table: Table, benchmark: Benchmark) -> str:
    """How much of a benchmark is in a table."""
    points = {(row["task"], json.dumps(row["point"], sort_keys=True)) for row in table.rows}
    whole = sum(count_points(benchmark.vary | task.vary) for task in benchmark.tasks.values())
    laws = len({row["law"] for row in table.rows})
    return f"Measured are {len(points)} of the {whole} points of version {benchmark.version}, with {laws} laws each."


if __name__ == "__main__":
    for name in sys.argv[1:]:
        page = Path(name)
        write_atomically(page, filled(page.read_text(encoding="utf-8")))
