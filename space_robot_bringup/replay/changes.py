"""What is configured otherwise than when a log was recorded."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from space_robot_bringup.experiment import Overrides, experiment_from, with_overrides


def changed(data: Mapping[str, Any], overrides: Overrides, where: str) -> dict[str, tuple[Any, Any]]:
    """Dotted key to (recorded, now) of every value of the resolved experiment that the overrides change.

    Args:
        data: the recorded experiment.
        overrides: see ``load_experiment``.
        where: its name, for errors.
    """
    if not overrides:
        return {}
    before = flat(experiment_from(data, where).model_dump(mode="json"))
    now = flat(experiment_from(with_overrides(data, overrides), where).model_dump(mode="json"))
    keys = dict.fromkeys((*before, *now))
    return {key: (before.get(key), now.get(key)) for key in keys if before.get(key) != now.get(key)}


def flat(data: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Values by dotted key; lists are values."""
    found: dict[str, Any] = {}
    for key, value in data.items():
        found |= flat(value, f"{prefix}{key}.") if isinstance(value, Mapping) and value else {f"{prefix}{key}": value}
    return found
