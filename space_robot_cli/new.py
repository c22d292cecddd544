"""A start for a file of one's own: it works as it is written, and its comments say what to change."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

from space_robot_msgs_py.errors import InputFileError, SpecError

# Kind to the endings of its files; the first is the one to begin with.
KINDS = {"experiment": ("yaml",), "law": ("py",), "robot": ("yaml", "urdf"), "study": ("yaml",)}
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def write_new(kind: str, place: Path) -> list[Path]:
    """Write the start of a kind of file.

    Args:
        kind: of ``KINDS``.
        place: its path, without an ending or with that of the kind.

    Returns:
        What was written, the file to begin with first.

    Raises:
        SpecError: no such kind, the name is no name, or a file of it is there already; nothing was written.
        InputFileError: it cannot be written there.
    """
    if kind not in KINDS:
        raise SpecError("no such kind", key="KIND", value=kind, accepted=", ".join(KINDS))
    endings = KINDS[kind]
    name = place.name.removesuffix(f".{endings[0]}")
    if not _NAME.fullmatch(name):
        raise SpecError("no name", key="NAME", value=place.name, accepted="a letter, then letters, digits, underscores")
    paths = [place.with_name(f"{name}.{ending}") for ending in endings]
    for path in paths:
        if path.exists():
            raise SpecError("is there already", key="NAME", value=str(path), accepted="a name that is free")
    for path, ending in zip(paths, endings, strict=True):
        _write(path, _text(kind, ending, name))
    return paths


def _text(kind: str, ending: str, name: str) -> str:
    text = files(__package__).joinpath("templates", f"{kind}.{ending}.txt").read_text(encoding="utf-8")
    words = {"FILE": name, "LAW": name.lower(), "CLASS": "".join(part.capitalize() for part in name.split("_"))}
    return re.sub(r"\b(FILE|LAW|CLASS)\b", lambda found: words[found[0]], text)


def _write(path: Path, text: str) -> None:
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise InputFileError(f"cannot be written: {error.strerror}", key=str(path)) from None
