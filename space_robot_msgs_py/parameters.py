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
