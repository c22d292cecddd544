"""What is shipped, with a line on each."""

from __future__ import annotations

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_studies.campaign.spec import read_campaign
from space_robot_studies.reproduce.plan import manifest_path, read_manifest


def catalogue() -> dict[str, dict[str, str]]:
    """Kind to name to one line."""
    return {
        "experiments": {name: _experiment(name) for name in shipped("experiments")},
        "papers": {name: _paper(name) for name in shipped("papers")},
        "campaigns": {name: _campaign(name) for name in shipped("campaigns")},
        "robots": {name: _robot(name) for name in shipped("robots")},
    }


def _experiment(name: str) -> str:
    spec = load_experiment(name)
    return f"{spec.title} ({spec.source})" if spec.source else spec.title


def _paper(name: str) -> str:
    manifest = read_manifest(manifest_path(name), name)
    return f"{manifest.title} ({manifest.citation})"


def _campaign(name: str) -> str:
    spec = read_campaign(name)
    return f"{spec.runs} runs: {spec.title}"


def _robot(name: str) -> str:
    # A robot whose arm comes with a package that is not installed here is shipped all the same.
    try:
        robot = load_robot(name)
    except SpaceRobotError as error:
        return f"not available here: {error}"
    return f"{robot.n} joints, {robot.base_mode}; {robot.resolved['description']}"
