"""What varies from run to run, in the words of every study file: vary, seeds."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Annotated, Any

from pydantic import Field, NonNegativeInt

from space_robot_description.spec import Strict

MAX_SEEDS = 100_000
Vary = dict[str, tuple[Any, ...] | dict[str, Any]]
VARY = "dotted key -> its values, or label -> value; all combinations are run"


class SeedRange(Strict):
    """Many seeds in a row."""

    first: NonNegativeInt = 0
    count: Annotated[int, Field(ge=1, le=MAX_SEEDS)]


Seeds = tuple[NonNegativeInt, ...] | SeedRange


@dataclass(frozen=True, slots=True)
class Point:
    """One combination of what is varied on purpose.

    Attributes:
        labels: key to what stands for its value in tables.
        values: key to value.
    """

    labels: Mapping[str, Any]
    values: Mapping[str, Any]


def check_vary(vary: Vary) -> None:
    """Refuse a key without values.

    Raises:
        ValueError: names it.
    """
    for key, values in vary.items():
        if not values:
            raise ValueError(f"vary.{key} has no value")


def check_seeds(seeds: Seeds) -> None:
    """Refuse a seed that stands there twice.

    Raises:
        ValueError: there is one.
    """
    if len(set(seed_list(seeds))) != len(seed_list(seeds)):
        raise ValueError("a seed stands there twice")


def seed_list(seeds: Seeds) -> tuple[int, ...]:
    """Every seed, in order."""
    return tuple(range(seeds.first, seeds.first + seeds.count)) if isinstance(seeds, SeedRange) else seeds


def count_points(vary: Vary) -> int:
    """Number of combinations; 1 where nothing is varied."""
    return prod(len(values) for values in vary.values())


def point_at(vary: Vary, at: int) -> Point:
    """One combination; the last key varies fastest."""
    labels, values = {}, {}
    for key, choices in reversed(vary.items()):
        at, which = divmod(at, len(choices))
        labelled = list(choices.items()) if isinstance(choices, dict) else [(_label(c), c) for c in choices]
        labels[key], values[key] = labelled[which]
    return Point({key: labels[key] for key in vary}, {key: values[key] for key in vary})


def _label(value: Any) -> Any:
    return value if isinstance(value, str | int | float | None) else json.dumps(value, sort_keys=True, default=str)
