"""The manifest of a paper, typed: the runs of a figure, what is drawn of them, what the paper says about them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    Field,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    field_validator,
    model_validator,
)

from space_robot_description.spec import Strict
from space_robot_studies.campaign.distributions import Draw
from space_robot_studies.campaign.variation import VARY, Seeds, Vary, check_seeds, check_vary, count_points, seed_list
from space_robot_studies.reproduce.quantities import Measure, Number, Texts
from space_robot_studies.reproduce.stability_map import StabilityMap

VERDICTS = ("holds", "does not hold", "too close", "not checkable", "study")
Scale = Literal["linear", "log", "symlog"]
# More bags than this fill a disk sooner than they are looked at.
MAX_KEPT = 40
MAX_RUNS = 10_000


class RunGroup(Strict):
    """Runs under one label: every combination of varied values and seeds, dispersed runs, or cases of a campaign.

    The keys mean what they mean in a campaign file.
    """

    RENAMED: ClassVar[Mapping[str, str]] = {"sweep": "vary", "at": "where"}

    experiment: str = Field(default="", description="shipped name, or a YAML file relative to the manifest")
    campaign: str = Field(default="", description="instead of an experiment: a campaign, named likewise")
    where: dict[str, Any] = Field(
        default_factory=dict, description="of a campaign: only points where these are varied so"
    )
    set: dict[str, Any] = Field(default_factory=dict, description="overrides of every run, dotted key -> value")
    vary: Vary = Field(default_factory=dict, description=VARY)
    seeds: Seeds = Field(default=(), description="of the experiments: one run per seed")
    disperse: dict[str, Draw] = Field(default_factory=dict, description="dotted key -> how it is dispersed")
    runs: PositiveInt | None = Field(
        default=None, description="per point, with disperse or of a campaign; default: the campaign's, one per seed"
    )
    seed: NonNegativeInt = Field(default=0, description="of all draws, with disperse")
    may_fail: bool = Field(default=False, description="a run that does not complete is a result, not a failure")

    @property
    def seed_list(self) -> tuple[int, ...]:
        """Every seed, in order."""
        return seed_list(self.seeds)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if bool(self.experiment) == bool(self.campaign):
            raise ValueError("give experiment or campaign")
        drawn = bool(self.disperse) or "seed" in self.model_fields_set
        if self.campaign and (self.vary or self.seed_list or drawn):
            raise ValueError("a campaign has its own grid, seeds and draws: give runs and where")
        if self.experiment and self.where:
            raise ValueError("where belongs to a campaign")
        if self.experiment and not self.disperse and (self.runs is not None or drawn):
            raise ValueError("runs and seed belong to disperse, or to a campaign")
        if self.disperse and self.runs is None and not self.seed_list:
            raise ValueError("with disperse: give runs or seeds")
        return self

    @model_validator(mode="after")
    def _said_once(self) -> Self:
        check_vary(self.vary)
        check_seeds(self.seeds)
        twice = (self.set.keys() & self.vary.keys()) | (self.disperse.keys() & (self.set.keys() | self.vary.keys()))
        if self.seed_list:
            twice |= {"seed"} & (self.set.keys() | self.vary.keys() | self.disperse.keys())
        if twice:
            raise ValueError(f"{min(twice)} is given twice")
        if wrong := [key for key in (*self.set, *self.vary) if not key.strip() or "=" in key]:
            raise ValueError(f"{wrong[0]!r} is no dotted key")
        return self

    @model_validator(mode="after")
    def _countable(self) -> Self:
        runs = count_points(self.vary) * (self.runs or max(1, len(self.seed_list)))
        if runs > MAX_RUNS:
            raise ValueError(f"at most {MAX_RUNS} runs, not {runs}")
        return self


class Value(Strict):
    """One way to read what a paper leaves open."""

    set: dict[str, Any] = Field(default_factory=dict, description="overrides of the runs, dotted key -> value")
    let: dict[str, float | str] = Field(
        default_factory=dict, description="name -> number, or formula over the measures, for the condition"
    )


class Choice(Strict):
    """Something a paper leaves open, or that is ours, and the plausible ways to read it."""

    open: str = Field(min_length=1, description="what is open, and why each value is plausible")
    ours: bool = Field(default=False, description="a threshold or setting of the project, not of the paper")
    of: Texts | None = Field(default=None, description="groups that `set` changes; default: all that a claim measures")
    values: dict[str, Value] = Field(min_length=2, description="name -> reading; the first is that of the figures")

    @model_validator(mode="after")
    def _same_names(self) -> Self:
        names = [set(value.let) for value in self.values.values()]
        if any(other != names[0] for other in names):
            raise ValueError("every value gives the same names under let")
        if not any(value.let or value.set for value in self.values.values()):
            raise ValueError("no value gives set or let: nothing is chosen")
        return self


class Claim(Strict):
    """What the paper says and how it is checked; without holds_if a study, which measures and judges nothing."""

    RENAMED: ClassVar[Mapping[str, str]] = {"verdict": "expect"}

    paper: str = Field(min_length=1, description="the paper's words; of a study what is asked")
    hangs_on: tuple[str, ...] = Field(default=(), description="choices: the claim is judged in every reading of them")
    measures: dict[str, Measure] = Field(default_factory=dict, description="name -> number")
    derived: dict[str, str] = Field(default_factory=dict, description="name -> formula over the measures")
    holds_if: str = Field(default="", description="a condition over the measures")
    found: str = Field(default="", description="what was measured: a format string over the numbers, n and seeds")
    expect: str = Field(
        default="", description="the verdict that is expected: another one that is computed is an error"
    )
    because: str = Field(default="", description="why, in a sentence or two")

    @field_validator("expect")
    @classmethod
    def _verdict(cls, expect: str) -> str:
        if expect and expect not in VERDICTS and not expect.startswith("depends on "):
            raise ValueError(f"no verdict; accepted: {', '.join(VERDICTS)}, depends on CHOICE")
        return expect

    @model_validator(mode="after")
    def _checkable(self) -> Self:
        if not self.measures:
            if self.derived or self.holds_if or self.found or self.hangs_on:
                raise ValueError("a claim without measures has no derived, holds_if, found or hangs_on")
            if not self.because:
                raise ValueError("a claim without measures is not checkable and says because")
        elif not self.found:
            raise ValueError("a claim with measures says what was found")
        return self


class Style(Strict):
    """How a group or a signal is drawn; what is not said is chosen."""

    color: str | None = None
    line: Literal["solid", "dashed", "dotted", "dashdot"] | None = None
    width: PositiveFloat | None = None

    @model_validator(mode="before")
    @classmethod
    def _color_alone(cls, data: Any) -> Any:
        return {"color": data} if isinstance(data, str) else data


class Drawing(Strict):
    """What panels and charts have in common."""

    of: Texts | None = Field(default=None, description="groups; default: all of the figure")
    label: str = Field(default="", description="of the vertical axis, with its unit; default: what is drawn")
    legend: dict[str, str] = Field(default_factory=dict, description="group or signal -> text; empty text: no entry")
    style: dict[str, Style] = Field(default_factory=dict, description="group or signal -> color, or a style")
    y_scale: Scale = "linear"
    limits: tuple[float, float] | None = Field(default=None, description="of the vertical axis")


class Panel(Drawing):
    """Signals over time, one curve per run."""

    signals: Texts
    after: NonNegativeFloat = Field(default=0.0, description="drawn from here [s]")
    before: PositiveFloat | None = Field(default=None, description="drawn up to here [s]")


class Chart(Drawing):
    """A number of each run, over a key of the experiment or side by side by group."""

    measure: Number
    x: str = Field(default="", description="dotted key whose value is the abscissa; empty: one column per group")
    x_label: str = ""
    x_scale: Scale = "linear"
    marks: dict[str, float] = Field(default_factory=dict, description="text -> abscissa of a vertical line")


class Grid(Chart):
    """A number over two keys of the experiment, one cell per point of what is varied, with formulas drawn over it."""

    y: str = Field(min_length=1, description="dotted key whose value is the ordinate")
    y_label: str = ""
    lines: dict[str, str] = Field(default_factory=dict, description="text -> ordinate as a formula over x")


class Table(Strict):
    """One row per group, per point of what it varies (all seeds together) or per run, one column per number."""

    title: str = ""
    rows: Literal["groups", "points", "runs"] = "groups"
    of: Texts | None = Field(default=None, description="groups; default: all of the figure")
    columns: dict[str, Number] = Field(min_length=1, description="heading -> number")
    digits: Annotated[int, Field(ge=1, le=15)] = Field(default=4, description="significant digits")


class Timing(Strict):
    """How long one control cycle of the law takes on this machine, over the states and references of a run."""

    of: Texts = Field(description="groups of one run each")
    repeats: Annotated[int, Field(ge=10, le=10_000_000)] = 10_000


class Bounds(Strict):
    """A run has diverged if it did not complete or an error was ever larger than this."""

    attitude: PositiveFloat = Field(default=90.0, description="angle of the attitude error [deg]; 180 is never reached")
    joints: PositiveFloat = Field(default=180.0, description="largest joint error [deg]")
    position: PositiveFloat = Field(default=10.0, description="position error of a free-flying base [m]")


class Figure(Strict):
    """A figure or table of the paper, or a study beyond it."""

    title: str
    kind: Literal["paper", "beyond"] = "paper"
    caption: str = ""
    runs: dict[str, RunGroup] = Field(min_length=1, description="label -> runs")
    panels: tuple[Panel, ...] = ()
    charts: tuple[Chart, ...] = ()
    grids: tuple[Grid, ...] = ()
    maps: tuple[StabilityMap, ...] = ()
    tables: tuple[Table, ...] = ()
    timing: Timing | None = None
    diverged: Bounds = Field(default_factory=Bounds)
    keep: Literal["all", "failed", "none"] | None = Field(
        default=None, description=f"which bags stay; default: all of up to {MAX_KEPT} runs, else failed"
    )
    claims: tuple[Claim, ...] = ()


class Manifest(Strict):
    """One paper."""

    title: str
    citation: str
    notes: str = Field(default="", description="on top of the page: what the paper leaves open")
    choices: dict[str, Choice] = Field(default_factory=dict, description="name -> what is open, for claims to hang on")
    figures: dict[str, Figure] = Field(min_length=1, description="number or name -> figure")
