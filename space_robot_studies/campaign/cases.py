"""Run k of a campaign: a pure function of the campaign and k, in whatever order they are made."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from hashlib import sha256
from math import ceil
from typing import Any

import numpy as np

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.experiment import Experiment, experiment_from
from space_robot_description.frozen import plain
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.campaign.known_robots import known_content
from space_robot_studies.campaign.spec import Campaign

# A double holds it, so every reader of JSON does.
SEED_BITS = 53
# It takes about 10 ms each.
MAX_COMPOSED = 200


@dataclass(frozen=True, slots=True)
class Case:
    """One run of one point of the grid.

    Attributes:
        index: of the case, run * points + point: more runs renumber nothing.
        run: which draws.
        labels: key to label of what is varied.
        drawn: key to value of what is dispersed.
        seed: of the experiment.
        data: the experiment, not yet checked.
    """

    index: int
    run: int
    labels: Mapping[str, Any]
    drawn: Mapping[str, Any]
    seed: int
    data: Mapping[str, Any]

    def experiment(self) -> Experiment:
        """The checked experiment.

        Raises:
            SpecError: a drawn or varied value cannot be used.
        """
        return experiment_from(self.data, f"case {self.index}")

    def columns(self) -> dict[str, Any]:
        """What a table says about the case: index, run, seed, then what is varied and what was drawn."""
        columns: dict[str, Any] = {"index": self.index, "run": self.run, "seed": self.seed}
        for key, value in [*self.labels.items(), *self.drawn.items()]:
            columns |= {} if key == "seed" else _flat(key, value)
        return columns


def make_case(campaign: Campaign, index: int) -> Case:
    """Draw one case of a resolved campaign.

    Every key has a stream of its own, found by its name: a further key changes no draw of the others.

    Raises:
        SpecError: a key leads nowhere, or there is no such case.
    """
    if not 0 <= index < campaign.cases:
        raise SpecError("no such case", key="--index", value=index, accepted=f"0 to {campaign.cases - 1}")
    run, at = divmod(index, campaign.points)
    point = campaign.point(at)
    # The child that SeedSequence(seed).spawn(runs)[run] is, without making the others.
    child = np.random.SeedSequence(campaign.seed, spawn_key=(run,))
    drawn = {key: _sample(campaign, key, child) for key in campaign.disperse}
    seed = int(child.generate_state(1, np.uint64)[0] >> np.uint64(64 - SEED_BITS))
    if campaign.seed_list:
        seed = campaign.seed_list[run]
    data: dict[str, Any] = plain(campaign.experiment) | {"seed": seed}
    for section, values in (("vary", point.values), ("disperse", drawn)):
        for key, value in values.items():
            set_key(data, key, value, f"{section}.{key}")
    return Case(index, run, point.labels, drawn, data["seed"], data)


def check_cases(campaign: Campaign, stop: Callable[[], object] = lambda: None) -> list[Composition]:
    """Refuse a campaign with a case that cannot be run, as far as that can be known before.

    Every case must be a valid experiment. Composed are the first case of every point of the grid (of a large one, of
    points at equal distances) and those with the smallest and largest value of every drawn number.

    Args:
        campaign: resolved.
        stop: asked between two cases; a reason ends the check early.

    Returns:
        The composed first cases.

    Raises:
        SpaceRobotError: a case cannot be used; the message names it.
    """
    extremes: dict[str, list[tuple[float, int]]] = {}
    for index in range(campaign.cases):
        if stop() is not None:
            return []
        case = make_case(campaign, index)
        case.experiment()
        for key, value in case.columns().items():
            if isinstance(value, float) and index % campaign.points == 0:
                extremes.setdefault(key, []).append((value, index))
    first = range(0, campaign.points, ceil(campaign.points / MAX_COMPOSED))
    ends = {bound(found)[1] for found in extremes.values() for bound in (min, max)}
    composed = {index: _compose(campaign, index) for index in sorted({*first, *ends}) if stop() is None}
    return [composed[index] for index in first if index in composed]


def _compose(campaign: Campaign, index: int) -> Composition:
    case = make_case(campaign, index)
    try:
        return compose(case.experiment(), load=known_content)
    except SpaceRobotError as error:
        what = f"cannot be run: {error}"
    except (Exception, SystemExit) as error:
        # A custom law may raise anything while it is made.
        what = f"cannot be run: {type(error).__name__}: {error}"
    drawn = {key: value for key, value in case.columns().items() if key not in ("index", "run")}
    raise SpecError(what, key=f"case {index}", value=drawn, accepted="dispersions and values that can be run")


def _sample(campaign: Campaign, key: str, child: np.random.SeedSequence) -> Any:
    draw = campaign.disperse[key]
    if draw.same_as is not None:
        return _sample(campaign, draw.same_as, child)
    return draw.sample(np.random.default_rng(_stream(child, key)))


def _stream(child: np.random.SeedSequence, key: str) -> np.random.SeedSequence:
    name = int.from_bytes(sha256(key.encode()).digest()[:8], "big")
    return np.random.SeedSequence(child.entropy, spawn_key=(*child.spawn_key, name))


def _flat(key: str, value: Any) -> dict[str, Any]:
    """Lists of numbers as one column each, what no column can hold as JSON."""
    if isinstance(value, str | int | float | None):
        return {key: value}
    if isinstance(value, list | tuple) and _numbers(value):
        return {f"{key}.{place}": float(part) for place, part in enumerate(value)}
    return {key: json.dumps(value, sort_keys=True, default=str)}


def _numbers(values: Iterable[Any]) -> bool:
    return all(isinstance(value, int | float) for value in values)
