"""``python -m benchmarks [--write PAGE] [NAME ...]`` prints the tables, and writes them into a page."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

from benchmarks.machine import described
from benchmarks.page import write_table

NAMES = (
    "start",
    "plant",
    "adaptive",
    "loop",
    "fused",
    "supervision",
    "graph",
    "live",
    "log",
    "campaign",
    "scheduler",
    "report",
    "memory",
)


def main() -> int:
    """Run the named benchmarks, all of them by default."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}; default: all")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put each table into this page, in place of its last"
    )
    options = parser.parse_args()
    if unknown := [name for name in options.names if name not in NAMES]:
        parser.error(f"no such benchmark: {', '.join(unknown)}; accepted: {', '.join(NAMES)}")
    for name in options.names or NAMES:
        print(f"== {name}")
        rows = import_module(f"benchmarks.bench_{name}").run()
        for row, value in rows.items():
            print(f"  {row:<64} {value:>12.4g}")
        if options.write is not None:
            # At once: a later one may fail or be interrupted.
            write_table(options.write, name, rows, described())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
