"""What ``list`` says, which reads files without checking them."""

from __future__ import annotations

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_cli.catalogue import catalogue
from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_studies.campaign.spec import read_campaign


def test_lines_of_robots_are_those_of_the_robots_that_are_made() -> None:
    """Joints are counted in the URDF, without locked ones and what follows them."""
    said = catalogue("robots")["robots"]
    assert list(said) == shipped("robots")
    for name, line in said.items():
        robot = load_robot(name)
        assert line == f"{robot.n} joints, {robot.base_mode}; {robot.resolved['description']}"


def test_lines_of_experiments_and_campaigns_are_those_of_the_checked_files() -> None:
    """Titles and sources that stand in a base are found, runs that are counted by seeds, too."""
    for name, line in catalogue("experiments")["experiments"].items():
        spec = load_experiment(name)
        assert line == (f"{spec.title} ({spec.source})" if spec.source else spec.title)
    for name, line in catalogue("campaigns")["campaigns"].items():
        campaign = read_campaign(name)
        assert line == f"{campaign.runs} runs: {campaign.title}"
