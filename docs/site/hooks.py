"""What turns the pages of the repository into a site: pages from its root, the API's page, links, formulas."""

from __future__ import annotations

import posixpath
import re
from html import unescape
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

import space_robot

ROOT = Path(__file__).parents[2]
REPOSITORY = "https://github.com/space-robot/space-robot/blob/main/"
# Page of the site to file at the root of the repository.
AT_ROOT = {
    "index.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
    "security.md": "SECURITY.md",
}
OF_FILE = {file: page for page, file in AT_ROOT.items()}
LINK = re.compile(r"(\]\()([^)\s#:]+)((?:#[^)\s]*)?\))")
CODE = re.compile(r"^( *```.*?^ *```)", re.DOTALL | re.MULTILINE)
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Files, config: Any) -> Files:
    """Add what is not in docs/: the pages of the root, and a page with the docstring of every public name."""
    for page, file in AT_ROOT.items():
        files.append(File.generated(config, page, content=(ROOT / file).read_text(encoding="utf-8")))
    files.append(File.generated(config, "api.md", content=_api()))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Bend links: into docs/ for pages of the root, to the repository for what is not on the site."""
    name = page.file.src_uri
    folder = posixpath.dirname(f"docs/{name}") if name not in AT_ROOT else ""

    def bent(found: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, found[2]))
        if target in OF_FILE:
            target = f"docs/{OF_FILE[target]}"
        elif not target.startswith("docs/"):
            return f"{found[1]}{REPOSITORY}{target}{found[3]}"
        return f"{found[1]}{posixpath.relpath(target, posixpath.dirname(f'docs/{name}'))}{found[3]}"

    parts = CODE.split(markdown)
    return "".join(part if index % 2 else LINK.sub(bent, part) for index, part in enumerate(parts))


def on_page_content(html: str, **_: Any) -> str:
    """Formulas as MathML, which browsers draw by themselves: no script, and nothing from another server."""
    return FORMULA.sub(_mathml, html)


def _mathml(found: re.Match[str]) -> str:
    display = "block" if found[2] == "[" else "inline"
    # It knows no equation numbers at the margin: they follow their line.
    text = re.sub(r"\\tag\{(.*?)\}", r"\\qquad (\\text{\1})", unescape(found[3]).strip())
    return str(convert(text, display=display))


def _api() -> str:
    """A heading and an entry for every public name, in the order of the modules that have them."""
    lines = [
        "# API",
        "",
        "Every public name with its docstring; [Python](python.md) has them by what they are for.",
        "",
    ]
    for module, names in space_robot._MODULES.items():  # type: ignore[attr-defined]
        lines += [
            f"::: {module}.{name}\n" for name in names if not name.startswith("_") and name not in ("Blocks", "Vector")
        ]
    return "\n".join(lines)
