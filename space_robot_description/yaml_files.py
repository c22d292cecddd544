"""YAML files to plain data, and what is said of what cannot be read; quick to import, for it checks no types."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from space_robot_msgs_py.bounded_files import read_text
from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import YAML_BYTES


def parse_yaml(path: Path | str) -> dict[str, Any]:
    """Read a YAML 1.2 file whose top level is a mapping.

    Raises:
        InputFileError: the file is missing, too large or cannot be read.
        SpecError: not YAML (with line and column), a key twice, not a mapping, or a NaN or infinity in it.
    """
    return parse_yaml_text(read_text(Path(path), YAML_BYTES), str(path))


def parse_yaml_text(text: str, where: str) -> dict[str, Any]:
    """Parse YAML text whose top level is a mapping; ``where`` names it in errors.

    Raises:
        SpecError: see `parse_yaml`.
    """
    data = parse_yaml_value(text, where)
    if not isinstance(data, dict):
        raise SpecError(
            "the file does not hold a mapping", key=where, value=short_value(data), accepted="key: value lines"
        )
    if found := _non_finite(data, ()):
        key = f"{where} {'.'.join(found[0])}"
        raise SpecError("not a finite number", key=key, value=found[1], accepted="finite numbers")
    return data


def parse_yaml_value(text: str, where: str) -> Any:
    """Parse YAML text that may be anything: a mapping, a list, a number; ``where`` names it in errors.

    Raises:
        SpecError: not YAML (with line and column), a key twice, or beyond a limit; see ``load_yaml``.
    """
    return load_yaml(text, where)


def nearest(name: object, names: Iterable[str]) -> str:
    """Up to three names that look like the given one, comma separated; empty if none does."""
    return ", ".join(difflib.get_close_matches(str(name), list(names), n=3, cutoff=0.5))


def short_value(value: object) -> object:
    """Long values would bury the message."""
    return value if len(repr(value)) <= 80 else f"{repr(value)[:77]}..."


def _non_finite(value: object, path: tuple[str, ...]) -> tuple[tuple[str, ...], float] | None:
    """Path and value of the first NaN or infinity, depth first; the number of paths is bounded, see ``load_yaml``."""
    if isinstance(value, float):
        return None if math.isfinite(value) else (path, value)
    if not isinstance(value, dict | list):
        return None
    children = value.items() if isinstance(value, dict) else enumerate(value)
    for name, child in children:
        if found := _non_finite(child, (*path, str(name))):
            return found
    return None
