"""Results of a shipped benchmark on pages: ``python -m space_robot_studies.benchmark.docs FILE ...``.

A page has ``<!-- results of NAME -->`` or ``<!-- results of NAME in brief -->``, and ``<!-- end -->`` where they end.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.benchmark.page import brief_of, page_of
from space_robot_studies.benchmark.spec import benchmark_path, load_benchmark
from space_robot_studies.benchmark.table import read_table

MARKED = re.compile(r"(<!-- results of (\S+)( in brief)? -->\n).*?(<!-- end -->)", re.DOTALL)


def filled(text: str) -> str:
    """A page with the results of the shipped tables in their places.

    Raises:
        SpaceRobotError: a page names a benchmark that is not shipped.
    """

    def results(found: re.Match[str]) -> str:
        benchmark = load_benchmark(found[2])
        table = read_table(benchmark_path(found[2]).with_suffix(".json"), benchmark)
        titles = {name: task.title for name, task in benchmark.tasks.items()}
        return f"{found[1]}\n{(brief_of if found[3] else page_of)(table, titles)}\n{found[4]}"

    return MARKED.sub(results, text)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        page = Path(name)
        write_atomically(page, filled(page.read_text(encoding="utf-8")))
