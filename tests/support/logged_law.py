"""What a log says of the law of its run."""

from __future__ import annotations

from space_robot_description.validation import parse_yaml_text


def law_of(text: str) -> str:
    """The law a log says it was run by."""
    return str(parse_yaml_text(text, "log")["controller"]["law"])
