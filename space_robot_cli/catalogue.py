"""What is shipped, with a line on each."""

from __future__ import annotations

from collections.abc import Iterator

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.load import load_robot
from space_robot_description.share import config_dir, shipped
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_sim.faults.catalogue import common_keys, groups, keys_of, meaning
from space_robot_studies.campaign.spec import read_campaign
from space_robot_studies.reproduce.plan import manifest_path, read_manifest
from space_robot_supervisor.table import SupervisionTable


def catalogue(kind: str = "") -> dict[str, dict[str, str]]:
    """Kind to name to one line, of one kind or of all.

    Raises:
        SpecError: there is no such kind.
    """
    says = {
        "experiments": _experiment,
        "papers": _paper,
        "campaigns": _campaign,
        "supervision": _table,
        "robots": _robot,
    }
    if kind and kind not in says:
        raise SpecError("no such kind", key="KIND", value=kind, accepted=", ".join((*says, "faults")))
    return {one: {name: say(name) for name in shipped(one)} for one, say in says.items() if kind in ("", one)}


def faults() -> Iterator[str]:
    """Every kind of fault with its keys, as lines."""
    for group, kinds in groups().items():
        yield group
        for kind in kinds:
            yield f"  {kind:<22}{meaning(kind)}"
            for key in keys_of(kind):
                default = f" (default {key.default})" if key.default else ""
                yield f"    {key.name:<20}{key.meaning}{default}"
    yield "all"
    for key in common_keys():
        yield f"    {key.name:<20}{key.meaning}"


def _experiment(name: str) -> str:
    spec = load_experiment(name)
    return f"{spec.title} ({spec.source})" if spec.source else spec.title


def _paper(name: str) -> str:
    manifest = read_manifest(manifest_path(name), name)
    return f"{manifest.title} ({manifest.citation})"


def _campaign(name: str) -> str:
    spec = read_campaign(name)
    return f"{spec.runs} runs: {spec.title}"


def _table(name: str) -> str:
    return validate(SupervisionTable, parse_yaml(config_dir() / "supervision" / f"{name}.yaml"), name).title


def _robot(name: str) -> str:
    # A robot whose arm comes with a package that is not installed here is shipped all the same.
    try:
        robot = load_robot(name)
    except SpaceRobotError as error:
        return f"not available here: {error}"
    return f"{robot.n} joints, {robot.base_mode}; {robot.resolved['description']}"
