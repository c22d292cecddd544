"""The tuning file: a task with its draws, the laws and what of them may change, what is wanted, and the budget."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt, model_validator

from space_robot_control.laws.gain_range import GainRange
from space_robot_description.share import shipped_or_file
from space_robot_description.spec import Strict, Title
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.campaign.distributions import Draw
from space_robot_studies.campaign.spec import Campaign, resolved, with_files
from space_robot_studies.campaign.variation import VARY, Point, Vary, check_vary, count_points, point_at

MAX_RUNS = 1_000_000


class RangeSpec(Strict):
    """See ``GainRange``."""

    low: float = Field(description="smallest value that is tried, in the unit of the gain")
    high: float = Field(description="largest")
    scale: Literal["log", "linear"] = Field(default="log", description="equal ratios or equal differences count alike")


class TunedLaw(Strict):
    """A law and what of its gains may change."""

    law: str = Field(default="", description="name of a law, or module:Class; default: the name it stands under")
    gains: dict[str, Any] = Field(default_factory=dict, description="of every evaluation; with them it is shipped")
    ranges: dict[str, RangeSpec] = Field(
        default_factory=dict, description="dotted name of a gain -> range; default: what the law declares"
    )


class Objective(Strict):
    """What is to be small."""

    minimise: dict[str, PositiveFloat] = Field(
        default_factory=lambda: {"joint_error": 1.0, "attitude_rms": 1.0, "torque_integral": 0.01},
        description="number of a run -> weight of it in the sum",
    )
    over: Literal["mean", "worst"] = Field(default="mean", description="of the draws")


class Tuning(Strict):
    """A tuning file; every law gets the same draws and the same number of evaluations at every point of the grid."""

    title: Title = ""
    experiment: str | dict[str, Any]
    set: dict[str, Any] = Field(default_factory=dict, description="dotted key of the experiment -> value, for all runs")
    disperse: dict[str, Draw] = Field(default_factory=dict, description="dotted key -> how it is dispersed")
    vary: Vary = Field(default_factory=dict, description=f"{VARY}; each is tuned by itself")
    laws: dict[str, TunedLaw] = Field(min_length=1, description="name in the tables -> law, and what may change")
    objective: Objective = Field(default_factory=Objective, description="what is to be small")
    constraints: dict[str, PositiveFloat] = Field(
        default_factory=dict, description="number of a run -> largest value, in every draw"
    )
    budget: PositiveInt = Field(default=60, description="evaluations per law and point, the shipped gains among them")
    draws: PositiveInt = Field(default=2, description="runs of an evaluation")
    held_out: PositiveInt = Field(default=20, description="draws that the search never sees, to judge the best gains")
    seed: NonNegativeInt = Field(default=0, description="of the draws and of the search")

    @model_validator(mode="after")
    def _can_run(self) -> Self:
        check_vary(self.vary)
        if wrong := [key for key in self.vary if key.split(".")[0] == "controller"]:
            raise ValueError(f"vary.{wrong[0]}: laws and their gains stand in laws")
        if not self.objective.minimise:
            raise ValueError("objective.minimise names no number")
        if (runs := self.runs) > MAX_RUNS:
            raise ValueError(f"{runs} runs; at most {MAX_RUNS}")
        return self

    @property
    def runs(self) -> int:
        """How many runs the search and the held-out draws are; sensitivity comes on top."""
        return len(self.laws) * count_points(self.vary) * (self.budget * self.draws + 2 * self.held_out)

    @property
    def points(self) -> tuple[Point, ...]:
        """The combinations of what is varied; a label without a letter goes without saying.

        So a file can vary another key and keep what is known of its points: names, searches and results are those that
        they had before.
        """
        points = (point_at(self.vary, at) for at in range(count_points(self.vary)))
        return tuple(replace(one, labels={k: v for k, v in one.labels.items() if v != ""}) for one in points)

    def campaign(self) -> Campaign:
        """The draws of a resolved file: first those of the search, then the held-out ones."""
        return Campaign(
            experiment=self.experiment,
            disperse=self.disperse,
            vary=self.vary,
            seed=self.seed,
            runs=self.draws + self.held_out,
        )


def tuning_path(name_or_path: StrPath) -> Path:
    """The file of a shipped tuning, or the given path."""
    return shipped_or_file(str(name_or_path), "tuning", key="tuning", message="no such tuning file or shipped tuning")


def read_tuning(name_or_path: StrPath, *, budget: int | None = None) -> Tuning:
    """A tuning file as it stands; see ``load_tuning``."""
    data = parse_yaml(tuning_path(name_or_path))
    if budget is not None:
        if budget < 1:
            raise SpecError("nothing can be searched", key="--budget", value=budget, accepted="1 or more evaluations")
        data = data | {"budget": budget}
    return validate(Tuning, data, str(name_or_path))


def load_tuning(name_or_path: StrPath, *, laws: tuple[str, ...] = (), budget: int | None = None) -> Tuning:
    """Read a tuning file and resolve it: the result holds its experiment and needs no other file, laws excepted.

    Args:
        name_or_path: a shipped name such as ``tune_short``, or the path of a YAML file.
        laws: only these of the file; none: all.
        budget: instead of what the file says.

    Raises:
        InputFileError: there is no such file.
        SpecError: a key or value cannot be used.
    """
    path, tuning = tuning_path(name_or_path), read_tuning(name_or_path, budget=budget)
    for law in laws:
        if law not in tuning.laws:
            accepted = nearest(law, tuple(tuning.laws)) or ", ".join(tuning.laws)
            raise SpecError("is not in this file", key="--law", value=law, accepted=accepted)
    chosen = {name: law for name, law in tuning.laws.items() if not laws or name in laws}
    return resolve_tuning(tuning.model_copy(update={"laws": chosen}), path)


def resolve_tuning(tuning: Tuning, path: Path) -> Tuning:
    """A tuning that stands in this file with its experiment in it; see ``load_tuning``."""
    campaign = with_files(
        Campaign(experiment=tuning.experiment, set=tuning.set, disperse=tuning.disperse, vary=tuning.vary, runs=1),
        path.parent,
    )
    whole = {"experiment": resolved(campaign, path).experiment, "set": {}, "disperse": campaign.disperse}
    return tuning.model_copy(update=whole | {"vary": campaign.vary, "laws": _located(tuning.laws, path.parent)})


def _located(laws: dict[str, TunedLaw], folder: Path) -> dict[str, TunedLaw]:
    """Laws in files beside the tuning file, and those without a name of their own, by their whole names."""
    found = {}
    for name, law in laws.items():
        file, colon, cls = (law.law or name).rpartition(":")
        beside = folder / file
        whole = f"{beside}:{cls}" if colon and file.endswith(".py") and beside.is_file() else law.law or name
        found[name] = law.model_copy(update={"law": whole})
    return found


def range_of(spec: RangeSpec, key: str) -> GainRange:
    """The range of a file.

    Raises:
        SpecError: it is empty; the message has the key that was typed.
    """
    try:
        return GainRange(spec.low, spec.high, spec.scale)
    except SpecError as error:
        raise SpecError(error.message, key=key, value=error.value, accepted=error.accepted) from None
