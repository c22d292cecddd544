"""Dotted keys: how the command line and campaigns name a place in an experiment."""

from __future__ import annotations

from typing import Any

from space_robot_control.per_dof import PARTS
from space_robot_description.frozen import plain
from space_robot_msgs_py.errors import SpecError

LAW_KEY = "controller.law"


def set_key(data: dict[str, Any], key: str, value: Any, where: str) -> None:
    """Set one dotted key in a mapping, making the sections on the way; another law drops the gains of the one before.

    Args:
        data: what is changed.
        key: a number in it is an item of a list; where one number stands for translation, rotation and joints, one of
            them may be set, and the others keep it; a name with dots, such as a body's in ``dispersion.parameters``, is
            found where it already stands.
        value: the new value; a copy of it is set.
        where: what is being set, for errors.

    Raises:
        SpecError: the key leads through a value or beyond the end of a list.
    """
    controller = data.get("controller")
    if key == LAW_KEY and isinstance(controller, dict) and controller.get("law") != value:
        controller.pop("gains", None)
    place: Any = data
    while key:
        there = [name for name in place if f"{key}.".startswith(f"{name}.")] if isinstance(place, dict) else []
        name = max(there, key=len, default=key.partition(".")[0])
        key = key[len(name) + 1 :]
        slot = _slot(place, name, where)
        if not key:
            place[slot] = plain(value)
        elif isinstance(place, dict) and key.partition(".")[0] in PARTS and _is_number(place.get(slot)):
            place[slot] = dict.fromkeys(PARTS, place[slot])
        elif isinstance(place, dict) and place.get(slot) is None:
            place[slot] = {}
        place = place[slot]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _slot(place: Any, name: str, where: str) -> str | int:
    if isinstance(place, dict):
        return name
    if isinstance(place, list) and name.isdecimal() and int(name) < len(place):
        return int(name)
    accepted = f"items 0 to {len(place) - 1}" if isinstance(place, list) else "a key of a section"
    raise SpecError(f"leads to {name!r} in what is no section", key=where, value=place, accepted=accepted)
