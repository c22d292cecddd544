"""The campaign file: one experiment, what strays, what is varied on purpose, and how many runs."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, Self

from pydantic import Field, NonNegativeInt, PositiveInt, model_validator

from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.experiment import Expectation, experiment_from, experiment_path, located
from space_robot_description.load import load_robot
from space_robot_description.share import is_file, shipped_or_file
from space_robot_description.spec import Strict, Title
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.campaign.distributions import Draw

# Keys whose value may point at a file beside the campaign file.
POINTING = ("robot", "reference")
# All of them are checked before the first is flown, which takes a millisecond each, and held in memory at the end.
MOST_CASES = 100_000


@dataclass(frozen=True, slots=True)
class Point:
    """One combination of what is varied on purpose.

    Attributes:
        labels: key to what stands for its value in tables.
        values: key to value.
    """

    labels: Mapping[str, Any]
    values: Mapping[str, Any]


class Campaign(Strict):
    """Runs that differ in what is drawn; every point of the grid gets the same draws, so that points compare in pairs.

    ``experiment`` is a shipped name, the path of an experiment file (relative to this file), or, in a resolved
    campaign, its content.
    """

    title: Title = ""
    source: Title = Field(default="", description="paper and figure this reproduces")
    experiment: str | dict[str, Any]
    set: dict[str, Any] = Field(default_factory=dict, description="dotted key of the experiment -> value, for all runs")
    runs: PositiveInt = Field(description="runs per point of the grid")
    seed: NonNegativeInt = Field(default=0, description="of all draws, and of the seeds of the runs")
    disperse: dict[str, Draw] = Field(default_factory=dict, description="dotted key of the experiment -> how it strays")
    vary: dict[str, tuple[Any, ...] | dict[str, Any]] = Field(
        default_factory=dict, description="dotted key -> its values, or label -> value; all combinations are flown"
    )
    expect: dict[str, Expectation] = Field(default_factory=dict, description="number of the summary -> bound")

    @model_validator(mode="after")
    def _can_fly(self) -> Self:
        for key, values in self.vary.items():
            if not values:
                raise ValueError(f"vary.{key} has no value")
            if key in self.disperse:
                raise ValueError(f"{key} is both varied and dispersed")
        for key, draw in self.disperse.items():
            other = self.disperse.get(draw.same_as or "")
            if draw.same_as is not None and (other is None or other.same_as is not None):
                raise ValueError(f"disperse.{key}.same_as must name a key that is drawn by itself")
        if self.cases > MOST_CASES:
            raise ValueError(f"{self.cases} cases; at most {MOST_CASES}")
        return self

    @property
    def points(self) -> int:
        """Number of combinations of what is varied; 1 where nothing is."""
        return prod(len(values) for values in self.vary.values())

    @property
    def cases(self) -> int:
        """Number of runs of all points."""
        return self.runs * self.points

    def point(self, at: int) -> Point:
        """One combination of what is varied; the last key varies fastest."""
        labels, values = {}, {}
        for key, choices in reversed(self.vary.items()):
            at, which = divmod(at, len(choices))
            labelled = list(choices.items()) if isinstance(choices, dict) else [(_label(c), c) for c in choices]
            labels[key], values[key] = labelled[which]
        return Point({key: labels[key] for key in self.vary}, {key: values[key] for key in self.vary})


def load_campaign(name_or_path: StrPath, runs: int | None = None) -> Campaign:
    """Read a campaign and resolve it: the result holds its experiment, robot included, and needs no other file.

    Args:
        name_or_path: a shipped name such as ``fig08_dispersed``, or the path of a YAML file.
        runs: instead of what the file says.

    Raises:
        InputFileError: there is no such file.
        SpecError: a key or value cannot be used.
    """
    path, campaign = campaign_path(name_or_path), read_campaign(name_or_path, runs)
    return campaign.model_copy(update={"experiment": _experiment(campaign, path), "set": {}})


def read_campaign(name_or_path: StrPath, runs: int | None = None) -> Campaign:
    """The campaign as its file says it, with paths beside that file made whole; see ``load_campaign``."""
    path = campaign_path(name_or_path)
    data = parse_yaml(path)
    campaign = validate(Campaign, data if runs is None else data | {"runs": runs}, os.fspath(name_or_path))
    return _with_files(campaign, path.parent)


def campaign_path(name_or_path: StrPath) -> Path:
    """The file of a shipped campaign, or the given path."""
    message = "no such campaign file or shipped campaign"
    return shipped_or_file(str(name_or_path), "campaigns", key="campaign", message=message)


def _experiment(campaign: Campaign, path: Path) -> dict[str, Any]:
    """The experiment all runs start from, with every default written out."""
    if isinstance(campaign.experiment, str):
        beside = path.parent / campaign.experiment
        source = beside if is_file(beside) else experiment_path(campaign.experiment)
        data = located(parse_yaml(source), source.parent)
    else:
        data = located(campaign.experiment, path.parent)
    for key, value in campaign.set.items():
        set_key(data, key, value, f"set.{key}")
    experiment = experiment_from(data, f"{path.name} experiment")
    return experiment.model_dump(mode="json") | {"robot": dict(load_robot(experiment.robot).resolved)}


def _with_files(campaign: Campaign, folder: Path) -> Campaign:
    """The campaign with paths that are relative to its file made whole."""

    def whole(key: str, value: Any) -> Any:
        return located({key: value}, folder)[key] if key in POINTING else value

    vary = {
        key: {label: whole(key, value) for label, value in values.items()}
        if isinstance(values, dict)
        else tuple(whole(key, value) for value in values)
        for key, values in campaign.vary.items()
    }
    disperse = {
        key: Draw(choice=tuple(whole(key, value) for value in draw.choice)) if draw.choice is not None else draw
        for key, draw in campaign.disperse.items()
    }
    constant = {key: whole(key, value) for key, value in campaign.set.items()}
    return campaign.model_copy(update={"vary": vary, "disperse": disperse, "set": constant})


def _label(value: Any) -> Any:
    return value if isinstance(value, str | int | float | None) else json.dumps(value, sort_keys=True, default=str)
