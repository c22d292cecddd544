"""``python -m benchmarks [plant adaptive loop supervision graph live log ...]`` prints the tables."""

from __future__ import annotations

import sys
from importlib import import_module

NAMES = ("plant", "adaptive", "loop", "supervision", "graph", "live", "log", "campaign", "report", "memory")


def main() -> int:
    """Run the named benchmarks, all of them by default."""
    wanted = sys.argv[1:] or NAMES
    unknown = [name for name in wanted if name not in NAMES]
    if unknown:
        print(f"no such benchmark: {', '.join(unknown)}; accepted: {', '.join(NAMES)}", file=sys.stderr)
        return 2
    for name in wanted:
        print(f"== {name}")
        for row, value in import_module(f"benchmarks.bench_{name}").run().items():
            print(f"  {row:<64} {value:>12.4g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
