"""What is set over an experiment file: dotted keys and their values, as they were typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from space_robot_bringup.experiment.dotted_keys import LAW_KEY, set_key
from space_robot_description.frozen import plain
from space_robot_description.validation import parse_yaml_value
from space_robot_msgs_py.errors import SpecError


class Assignment(NamedTuple):
    """One key and the value it gets.

    Attributes:
        key: dotted.
        value: plain data.
        where: what to call it in an error: what the user typed.
    """

    key: str
    value: Any
    where: str


Overrides = Mapping[str, Any] | Sequence[str | Assignment]


def with_overrides(content: Mapping[str, Any], overrides: Overrides) -> dict[str, Any]:
    """A copy of the mapping, as plain data, with every override set.

    Raises:
        SpecError: an override is not one, or its key leads nowhere.
    """
    data: dict[str, Any] = plain(content)
    # The law first: gains given beside it are meant for it, those of the file's own law are not.
    for key, value, where in sorted(assignments(overrides), key=lambda assignment: assignment[0] != LAW_KEY):
        set_key(data, key, value, where)
    return data


def assignments(overrides: Overrides) -> list[Assignment]:
    """Each override, parsed."""
    if not isinstance(overrides, Mapping):
        given = [overrides] if isinstance(overrides, str) else overrides
        return [one if isinstance(one, Assignment) else parsed(one) for one in given]
    for key, value in overrides.items():
        if not (isinstance(key, str) and key.strip()):
            raise SpecError("not a dotted key", key="overrides", value=key, accepted="e.g. controller.gains.damping")
        try:
            plain(value)
        except ValueError as error:
            raise SpecError(str(error), key=key) from None
    return [Assignment(key.strip(), value, key.strip()) for key, value in overrides.items()]


def parsed(override: str, where: str = "") -> Assignment:
    """A text ``dotted.key=value`` with its value in YAML.

    Args:
        override: the text.
        where: what to call it in an error; default: --set and the key.

    Raises:
        SpecError: it is none.
    """
    key, equals, text = str(override).partition("=")
    if not equals or not key.strip():
        raise SpecError("not an assignment", key=where or "--set", value=override, accepted="dotted.key=value")
    where = where or f"--set {key}"
    return Assignment(key.strip(), parse_yaml_value(text, where), where)
