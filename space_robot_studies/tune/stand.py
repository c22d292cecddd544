"""A law at one point of the grid: what is searched there, and what was found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

import numpy as np

from space_robot_control.laws.gain_range import GainRange
from space_robot_control.laws.registry import law_class
from space_robot_description.frozen import plain
from space_robot_description.validation import nearest, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.tune.ranking import Evaluation
from space_robot_studies.tune.search import Search
from space_robot_studies.tune.spec import TunedLaw, Tuning, range_of

# Both ways from the best gains, as a share of the range of each.
NEIGHBOUR = 0.1


@dataclass(slots=True)
class Stand:
    """One search.

    Attributes:
        name: of the law in the tables.
        law: with the gains that stay.
        point: number of the point of the grid.
        labels: key to label of what is varied there.
        ranges: dotted name of a gain to its range.
        search: where to look next.
        evaluations: what was tried, the shipped gains first.
    """

    name: str
    law: TunedLaw
    point: int
    labels: Mapping[str, Any]
    ranges: Mapping[str, GainRange]
    search: Search
    evaluations: list[Evaluation] = field(default_factory=list)

    @property
    def where(self) -> str:
        """Law and point in words."""
        return ", ".join([self.name, *(f"{key} {label}" for key, label in self.labels.items())])

    def gains(self, candidate: Vector) -> dict[str, float]:
        """The gains at a candidate (dimensions,) in 0 to 1."""
        shares = zip(self.ranges.items(), candidate.tolist(), strict=True)
        return {name: one.at(share) for (name, one), share in shares}

    def neighbours(self, gains: Mapping[str, float]) -> list[dict[str, float]]:
        """The gains with one of them changed by ``NEIGHBOUR`` of its range, down and up, gain by gain."""
        return [
            dict(gains) | {name: one.at(one.share(gains[name]) + step)}
            for name, one in self.ranges.items()
            for step in (-NEIGHBOUR, NEIGHBOUR)
        ]

    @property
    def best(self) -> Evaluation:
        """The best evaluation, the earlier one of two equal ones."""
        return min(self.evaluations, key=lambda one: (one.rank, one.number))

    @property
    def shipped(self) -> Evaluation:
        """That of the gains of the file."""
        return self.evaluations[0]


def make_stands(tuning: Tuning) -> list[Stand]:
    """All searches of a resolved file, point by point, laws in the order of the file.

    Raises:
        SpecError: a law has nothing to search, or a gain or its range cannot be used; the message has the key.
    """
    found = []
    ranges = {name: ranges_of(name, law) for name, law in tuning.laws.items()}
    for at, point in enumerate(tuning.points):
        for name, law in tuning.laws.items():
            seed = np.random.SeedSequence([tuning.seed, _number(name), _number(repr(sorted(point.labels.items())))])
            search = Search(len(ranges[name]), tuning.budget - 1, seed)
            found.append(Stand(name, law, at, point.labels, ranges[name], search))
    return found


def ranges_of(name: str, law: TunedLaw) -> dict[str, GainRange]:
    """What is searched of a law: what the file says, else what the law declares.

    Raises:
        SpecError: nothing is; a gain that the law has not, or that does not take the ends of its range.
    """
    cls, key = law_class(law.law, f"laws.{name}.law"), f"laws.{name}"
    own = {gain: range_of(spec, f"{key}.ranges.{gain}") for gain, spec in law.ranges.items()}
    found = own or dict(cls.gain_ranges)
    if not found:
        accepted = f"ranges of its gains, here or as {cls.__name__}.gain_ranges"
        raise SpecError("has nothing to search", key=f"{key}.ranges", accepted=accepted)
    fields = {info.alias or field_name for field_name, info in cls.Gains.model_fields.items()}
    for gain, one in found.items():
        if (first := gain.partition(".")[0]) not in fields:
            accepted = nearest(first, tuple(sorted(fields))) or ", ".join(sorted(fields)) or "no gain: it has none"
            raise SpecError("is no gain of this law", key=f"{key}.ranges.{gain}", value=gain, accepted=accepted)
        for end in (one.low, one.high):
            validate(cls.Gains, _with(plain(law.gains), gain, end), f"{key}.ranges.{gain}: ")
    return found


def _with(gains: Mapping[str, Any], name: str, value: float) -> dict[str, Any]:
    first, _, rest = name.partition(".")
    if not rest:
        return dict(gains) | {first: value}
    inner = gains.get(first)
    return dict(gains) | {first: _with(inner if isinstance(inner, Mapping) else {}, rest, value)}


def _number(text: str) -> int:
    return int.from_bytes(sha256(text.encode()).digest()[:8], "big")
