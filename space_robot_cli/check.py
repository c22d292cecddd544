"""What ``space-robot check`` says of a file before the first run: an experiment, a campaign or a paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.diagnosis import all_of, diagnosed
from space_robot_bringup.compose.flexibility import modes_of
from space_robot_bringup.compose.foresight import foreseen
from space_robot_bringup.compose.memory import what_is_not_forgotten
from space_robot_bringup.experiment.experiment import read_experiment
from space_robot_cli.kinds import FOLDERS
from space_robot_msgs_py.errors import SpaceRobotError, SpecError


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


def check_file(
    name_or_path: str,
    kind: str,
    overrides: Sequence[str] = (),
    faults: Sequence[str] = (),
) -> Checked:
    """Check everything that can be checked before a run.

    Args:
        name_or_path: shipped name or YAML file.
        kind: see ``kind_of``.
        overrides: ``dotted.key=value`` of an experiment.
        faults: of an experiment, as ``--fault`` takes them.

    Raises:
        SpaceRobotError: what is wrong; the message names the key.
    """
    if kind not in FOLDERS:
        raise SpecError("no such kind", key="--kind", value=kind, accepted=", ".join(FOLDERS))
    for option, given in (("--set", overrides), ("--fault", faults)):
        if given and kind != "experiment":
            raise SpecError("is for experiments", key=option, value=list(given), accepted=f"keys in the {kind}'s file")
    if kind == "experiment":
        return _experiment(_diagnosed(name_or_path, overrides, faults))
    return _campaign(name_or_path) if kind == "campaign" else _paper(name_or_path)


def _diagnosed(name_or_path: str, overrides: Sequence[str], typed: Sequence[str]) -> Composition:
    """The experiment, composed, if nothing is wrong with it."""
    file = read_experiment(name_or_path)
    data = file.data(overrides)
    faults, errors = _parsed(typed)
    given = data.get("faults", [])
    if faults and isinstance(given, list):
        data["faults"] = [*given, *faults]
    try:
        composition = diagnosed(data, file.where)
    except SpaceRobotError as first:
        errors.insert(0, first)
    if errors:
        raise all_of(errors)
    return composition


def _parsed(typed: Sequence[str]) -> tuple[list[Any], list[SpaceRobotError]]:
    """The faults of the command line, and what is wrong with some of them."""
    faults, errors = list[Any](), list[SpaceRobotError]()
    for text in typed:
        # Here, as only an experiment with faults needs the models of all faults.
        from space_robot_sim.faults.catalogue import parse_fault

        try:
            faults.append(parse_fault(text))
        except SpaceRobotError as error:
            errors.append(error)
    return faults, errors


def _experiment(composition: Composition) -> Checked:
    spec = composition.experiment
    nominal, review = composition.nominal, composition.review()
    summary = (
        f"{nominal.name}, {nominal.n} joints, {spec.controller.law}, {spec.steps} periods of {spec.control_period:g} s"
    )
    plan = composition.faults
    faults = () if plan is None else tuple(f"fault {one.label}: {plan.window(one)}" for one in plan.planned)
    memory = tuple(filter(None, [what_is_not_forgotten(composition)]))
    modes = modes_of(spec, composition.truth)
    return Checked(
        summary, nominal.notes + review.facts + modes + faults, (*review.warnings, *memory, *foreseen(composition))
    )


def _campaign(name_or_path: str) -> Checked:
    from space_robot_studies.campaign.cases import check_cases
    from space_robot_studies.campaign.spec import load_campaign

    campaign = load_campaign(name_or_path)
    firsts = check_cases(campaign)
    facts = tuple(f"varies {key}: {', '.join(map(str, values))}" for key, values in campaign.vary.items())
    facts += tuple(f"draws {key}" for key in campaign.disperse)
    warnings = dict.fromkeys(
        warning for composition in firsts for warning in (*composition.review().warnings, *foreseen(composition))
    )
    summary = f"{campaign.cases} cases, {campaign.points} points of {campaign.runs} runs"
    return Checked(summary, facts, tuple(warnings))


def _paper(name_or_path: str) -> Checked:
    from space_robot_studies.reproduce.check import check_plan
    from space_robot_studies.reproduce.plan import load_plan

    plan = load_plan(name_or_path)
    check_plan(plan, plan.manifest.figures)
    facts = tuple(
        f"{figure}: {spec.title} ({sum(map(len, plan.runs[figure].values()))} runs, {len(spec.claims)} claims)"
        for figure, spec in plan.manifest.figures.items()
    )
    return Checked(f"{len(facts)} figures and studies, {len(plan.distinct_runs(plan.manifest.figures))} runs", facts)
