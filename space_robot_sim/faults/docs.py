"""The tables in docs/faults.md, from the classes of the faults.

The page has ``<!-- faults of GROUP ... -->``, a table, ``<!-- end -->``; ``python -m space_robot_sim.faults.docs
docs/faults.md`` brings the tables up to date.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

from space_robot_sim.faults.catalogue import Key, common_keys, groups, keys_of, meaning

_TABLE = re.compile(r"(<!-- faults of (\w+)\b[^>]*-->\n).*?(<!-- end -->)", re.DOTALL)


def filled(page: str) -> str:
    """Return the page with its tables up to date."""

    def table(found: re.Match[str]) -> str:
        begin, group, end = found.groups()
        return f"{begin}\n{common_table() if group == 'all' else group_table(group)}\n{end}"

    return _TABLE.sub(table, page)


def common_table() -> str:
    """Return a Markdown table of the keys that every fault has."""
    return _markdown(("key", "meaning"), [(f"`{key.name}`", key.meaning) for key in common_keys()])


def group_table(group: str) -> str:
    """Return a Markdown table of the kinds of a group with their keys."""
    rows = [(f"`{kind}`", meaning(kind), "; ".join(map(_said, keys_of(kind)))) for kind in groups()[group]]
    return _markdown(("kind", "what happens", "keys"), rows)


def _said(key: Key) -> str:
    default = f" ({key.default})" if key.default else ""
    return f"`{key.name}`{default}: {key.meaning}"


def _markdown(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *(tuple(cell.replace("|", "\\|") for cell in row) for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    for path in map(Path, sys.argv[1:]):
        path.write_text(filled(path.read_text(encoding="utf-8")), encoding="utf-8")
