"""What ``space-robot check`` says of a file before the first run: an experiment, a campaign or a paper."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.diagnosis import all_of, diagnosed
from space_robot_bringup.compose.foresight import foreseen
from space_robot_bringup.compose.memory import what_is_not_forgotten
from space_robot_bringup.experiment.experiment import Experiment, file_schema, read_experiment
from space_robot_bringup.modes.compilation import notice
from space_robot_description.share import is_file, shipped
from space_robot_description.spec import Strict
from space_robot_description.validation import parse_yaml
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_sim.faults.catalogue import parse_fault
from space_robot_studies.campaign.cases import check_cases
from space_robot_studies.campaign.spec import Campaign, load_campaign
from space_robot_studies.reproduce.check import check_plan
from space_robot_studies.reproduce.manifest import Manifest
from space_robot_studies.reproduce.plan import Plan, load_plan

KINDS: dict[str, type[Strict]] = {"experiment": Experiment, "campaign": Campaign, "paper": Manifest}
FOLDERS = {"experiment": "experiments", "campaign": "campaigns", "paper": "papers"}


@dataclass(frozen=True, slots=True)
class Checked:
    """The answer.

    Attributes:
        summary: one line.
        facts: what else is known of it.
        warnings: what it will run into.
    """

    summary: str
    facts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def kind_of(name_or_path: str) -> str:
    """``experiment``, ``campaign`` or ``paper``: by the keys of a file, by the folder of a shipped name.

    A name that is shipped as an experiment and as a campaign is the experiment.
    """
    if is_file(path := Path(name_or_path)):
        data: Any = parse_yaml(path)
        return "paper" if "figures" in data else "campaign" if "experiment" in data else "experiment"
    return next((kind for kind, folder in FOLDERS.items() if name_or_path in shipped(folder)), "experiment")


def schema_of(kind: str) -> dict[str, Any]:
    """The JSON schema of a kind of file.

    Raises:
        SpecError: there is no such kind.
    """
    if kind not in KINDS:
        raise SpecError("no such kind", key="KIND", value=kind, accepted=", ".join(KINDS))
    return file_schema() if kind == "experiment" else KINDS[kind].model_json_schema()


def check_file(
    name_or_path: str,
    kind: str,
    overrides: Sequence[str] = (),
    on_notice: Callable[[str], None] = lambda line: None,
    faults: Sequence[str] = (),
) -> Checked:
    """Check everything that can be checked before a run.

    Args:
        name_or_path: shipped name or YAML file.
        kind: see ``kind_of``.
        overrides: ``dotted.key=value`` of an experiment.
        on_notice: called with what has to be compiled before the answer.
        faults: of an experiment, as ``--fault`` takes them.

    Raises:
        SpaceRobotError: what is wrong; the message names the key.
    """
    if kind not in KINDS:
        raise SpecError("no such kind", key="--kind", value=kind, accepted=", ".join(KINDS))
    for option, given in (("--set", overrides), ("--fault", faults)):
        if given and kind != "experiment":
            raise SpecError("is for experiments", key=option, value=list(given), accepted=f"keys in the {kind}'s file")
    if kind == "experiment":
        return _experiment(_diagnosed(name_or_path, overrides, faults), on_notice)
    return _campaign(load_campaign(name_or_path)) if kind == "campaign" else _paper(load_plan(name_or_path))


def _diagnosed(name_or_path: str, overrides: Sequence[str], typed: Sequence[str]) -> Experiment:
    """The experiment, if nothing is wrong with it."""
    file = read_experiment(name_or_path)
    data, errors, faults = file.data(overrides), list[SpaceRobotError](), list[Any]()
    for text in typed:
        try:
            faults.append(parse_fault(text))
        except SpaceRobotError as error:
            errors.append(error)
    given = data.get("faults", [])
    if faults and isinstance(given, list):
        data["faults"] = [*given, *faults]
    try:
        experiment = diagnosed(data, file.where)
    except SpaceRobotError as first:
        errors.insert(0, first)
    if errors:
        raise all_of(errors)
    return experiment


def _experiment(spec: Experiment, on_notice: Callable[[str], None]) -> Checked:
    if line := notice(spec.controller.law_names, plant=False):
        on_notice(line)
    composition = compose(spec)
    nominal, review = composition.nominal, composition.review()
    summary = (
        f"{nominal.name}, {nominal.n} joints, {spec.controller.law}, {spec.steps} periods of {spec.control_period:g} s"
    )
    plan = composition.faults
    faults = () if plan is None else tuple(f"fault {one.label}: {plan.window(one)}" for one in plan.planned)
    memory = tuple(filter(None, [what_is_not_forgotten(composition)]))
    return Checked(summary, nominal.notes + review.facts + faults, (*review.warnings, *memory, *foreseen(composition)))


def _campaign(campaign: Campaign) -> Checked:
    firsts = check_cases(campaign)
    facts = tuple(f"varies {key}: {', '.join(map(str, values))}" for key, values in campaign.vary.items())
    facts += tuple(f"draws {key}" for key in campaign.disperse)
    warnings = dict.fromkeys(
        warning for composition in firsts for warning in (*composition.review().warnings, *foreseen(composition))
    )
    summary = f"{campaign.cases} cases, {campaign.points} points of {campaign.runs} runs"
    return Checked(summary, facts, tuple(warnings))


def _paper(plan: Plan) -> Checked:
    check_plan(plan, plan.manifest.figures)
    facts = tuple(
        f"{figure}: {spec.title} ({sum(map(len, plan.runs[figure].values()))} runs, {len(spec.claims)} claims)"
        for figure, spec in plan.manifest.figures.items()
    )
    return Checked(f"{len(facts)} figures and studies, {len(plan.distinct_runs(plan.manifest.figures))} runs", facts)
