"""The claims of a paper as a table of a document: of a page of its own, or between the marks of one that is there."""

from __future__ import annotations

import re
from pathlib import Path

from space_robot_cli.render.paper import markdown
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.reproduce.summary import Data

BLOCK = re.compile(r"(<!-- claims\b[^>]*-->\n).*?(<!-- end -->)", re.DOTALL)


def write_markdown(path: Path, data: Data) -> None:
    """Write the claims; of a page with ``<!-- claims ... -->`` and ``<!-- end -->`` only what is between them.

    Args:
        path: of the document.
        data: see ``summary``.

    Raises:
        LogError: it cannot be written.
    """
    text = markdown(data)
    page = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    if BLOCK.search(page):
        text = BLOCK.sub(lambda marks: f"{marks[1]}\n{text}\n{marks[2]}", page, count=1)
    write_atomically(path, text)
