"""The campaign file: one experiment, what is dispersed, what is varied on purpose, and how many runs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Self

from pydantic import Field, NonNegativeInt, PositiveInt, model_validator

from space_robot_bringup.experiment.base import with_base
from space_robot_bringup.experiment.dotted_keys import LAW_KEY, set_key
from space_robot_bringup.experiment.expectations import Expectation
from space_robot_bringup.experiment.experiment import Overrides, assignments, experiment_from, located, read_experiment
from space_robot_description.frozen import plain
from space_robot_description.load import load_robot
from space_robot_description.share import is_file, shipped_or_file
from space_robot_description.spec import Strict, Title
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.campaign.distributions import Draw
from space_robot_studies.campaign.run_count import runs_of
from space_robot_studies.campaign.variation import (
    VARY,
    Point,
    Seeds,
    Vary,
    check_seeds,
    check_vary,
    count_points,
    point_at,
    seed_list,
)

# Keys whose value may point at a file beside the campaign file.
POINTING = ("robot", "reference", "supervision")
# All of them are checked before the first is run, which takes a millisecond each, and held in memory at the end.
MAX_CASES = 100_000


class Campaign(Strict):
    """Runs that differ in what is drawn; every point of the grid gets the same draws, so that points compare in pairs.

    ``experiment`` is a shipped name, the path of an experiment file (relative to this file), or, in a resolved
    campaign, its content.
    """

    title: Title = ""
    source: Title = Field(default="", description="paper and figure this reproduces")
    experiment: str | dict[str, Any]
    set: dict[str, Any] = Field(default_factory=dict, description="dotted key of the experiment -> value, for all runs")
    seeds: Seeds = Field(default=(), description="of the experiments, run by run, instead of drawn ones")
    runs: PositiveInt = Field(description="runs per point of the grid; default: one per seed in seeds")
    seed: NonNegativeInt = Field(default=0, description="of all draws, and of the seeds of the runs")
    disperse: dict[str, Draw] = Field(default_factory=dict, description="dotted key -> how it is dispersed")
    vary: Vary = Field(default_factory=dict, description=VARY)
    expect: dict[str, Expectation] = Field(default_factory=dict, description="number of the summary -> bound")

    @model_validator(mode="before")
    @classmethod
    def _runs_of_seeds(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "runs" in data:
            return data
        count = runs_of(data)
        return data | {"runs": count} if count else data

    @model_validator(mode="after")
    def _can_run(self) -> Self:
        check_vary(self.vary)
        check_seeds(self.seeds)
        if twice := self.vary.keys() & self.disperse.keys():
            raise ValueError(f"{min(twice)} is both varied and dispersed")
        if self.seed_list and "seed" in self.vary.keys() | self.disperse.keys():
            raise ValueError("seed is both listed in seeds and varied or dispersed")
        if self.seed_list and self.runs > len(self.seed_list):
            raise ValueError(f"{self.runs} runs, but {len(self.seed_list)} seeds")
        for key, draw in self.disperse.items():
            other = self.disperse.get(draw.same_as or "")
            if draw.same_as is not None and (other is None or other.same_as is not None):
                raise ValueError(f"disperse.{key}.same_as must name a key that is drawn by itself")
        if self.cases > MAX_CASES:
            raise ValueError(f"{self.cases} cases; at most {MAX_CASES}")
        return self

    @property
    def seed_list(self) -> tuple[int, ...]:
        """Every seed of the experiments, in order; empty where they are drawn."""
        return seed_list(self.seeds)

    @property
    def points(self) -> int:
        """Number of combinations of what is varied; 1 where nothing is."""
        return count_points(self.vary)

    @property
    def cases(self) -> int:
        """Number of runs of all points."""
        return self.runs * self.points

    def point(self, at: int) -> Point:
        """One combination of what is varied; the last key varies fastest."""
        return point_at(self.vary, at)


def load_campaign(name_or_path: StrPath, runs: int | None = None, overrides: Overrides = ()) -> Campaign:
    """Read a campaign and resolve it: the result holds its experiment, robot included, and needs no other file.

    Args:
        name_or_path: a shipped name such as ``fig08_dispersed``, or the path of a YAML file.
        runs: instead of what the file says.
        overrides: of the experiment, for all runs: they join ``set``.

    Raises:
        InputFileError: there is no such file.
        SpecError: a key or value cannot be used.
    """
    return resolved(read_campaign(name_or_path, runs, overrides), campaign_path(name_or_path))


def resolved(campaign: Campaign, path: Path) -> Campaign:
    """A campaign that stands in this file with its experiment in it; see ``load_campaign``."""
    return campaign.model_copy(update={"experiment": _experiment(campaign, path), "set": {}})


def read_campaign(name_or_path: StrPath, runs: int | None = None, overrides: Overrides = ()) -> Campaign:
    """The campaign as its file says it, with paths beside that file made whole; see ``load_campaign``."""
    path = campaign_path(name_or_path)
    data = parse_yaml(path)
    campaign = validate(Campaign, data if runs is None else data | {"runs": runs}, os.fspath(name_or_path))
    # The law first: gains given beside it are meant for it. A path in an override is relative to where it was typed.
    given = sorted(assignments(overrides), key=lambda one: one[0] != LAW_KEY)
    typed = {key: plain(value) for key, value, _ in given}
    there = with_files(campaign, path.parent)
    return there.model_copy(update={"set": {**there.set, **typed}}) if typed else there


def campaign_path(name_or_path: StrPath) -> Path:
    """The file of a shipped campaign, or the given path."""
    message = "no such campaign file or shipped campaign"
    return shipped_or_file(str(name_or_path), "campaigns", key="campaign", message=message)


def _experiment(campaign: Campaign, path: Path) -> dict[str, Any]:
    """The experiment all runs start from, with every default written out."""
    if isinstance(campaign.experiment, str):
        beside = path.parent / campaign.experiment
        file = read_experiment(beside if is_file(beside) else campaign.experiment)
        data = located(file.content, file.folder)
    else:
        data = located(with_base(campaign.experiment, path.parent, f"{path} experiment"), path.parent)
    for key, value in campaign.set.items():
        set_key(data, key, value, f"set.{key}")
    experiment = experiment_from(data, f"{path.name} experiment")
    return experiment.model_dump(mode="json") | {"robot": dict(load_robot(experiment.robot).resolved)}


def with_files(campaign: Campaign, folder: Path) -> Campaign:
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
