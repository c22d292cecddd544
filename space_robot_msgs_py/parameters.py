"""A value that a node shows as a ROS parameter, without ROS."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter of a node.

    Attributes:
        name: dotted.
        value: plain data as in a file.
        description: for people, with the unit.
        dynamic: it may change during the run; all others are read-only.
        lower: bound of a number, None where there is none.
        upper: likewise.
    """

    name: str
    value: Any
    description: str = ""
    dynamic: bool = False
    lower: float | None = None
    upper: float | None = None


# Stands before what is said in place of a value that is too long to be shown.
_NOT_SHOWN = "not shown: "


def not_shown(what: str) -> str:
    """What a parameter says whose value is too long to be shown, or no plain one."""
    return f"{_NOT_SHOWN}{what}"


def is_not_shown(value: object) -> bool:
    """Whether a parameter only says that there is a value."""
    return isinstance(value, str) and value.startswith(_NOT_SHOWN)
