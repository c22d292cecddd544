"""Starts for files of one's own: each works as it is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_cli.new import KINDS
from tests.support.tool import Tool

LAW = ("--set", "controller.law=my_start.py:MyStart", "--set", "controller.gains={}")
CAMPAIGN = ("campaign", "my_start.yaml", "--out", "mc", "--runs", "2", "--workers", "1")
TRIED = {
    "experiment": (("check", "my_start.yaml"), ("run", "my_start.yaml", "--out", "bag")),
    "law": (
        ("check", "liu2023/fig08", *LAW),
        ("run", "liu2023/fig08", *LAW, "--set", "expect={base/roll.final_error: {max: 0.5}}", "--out", "bag"),
        ("replay", "bag", "--law", "my_start.py:MyStart"),
    ),
    "robot": (("robot", "my_start.yaml"),),
    "study": (
        ("check", "my_start.yaml"),
        CAMPAIGN,
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_start_works_as_it_is_written(space_robot: Tool, kind: str) -> None:
    """Its own commands end with 0, in silence where nothing is odd."""
    written = space_robot("new", kind, "my_start")
    assert written.returncode == 0, written.stderr
    assert written.stdout.split()[1::2] == [f"my_start.{ending}" for ending in KINDS[kind]]
    for command in TRIED[kind]:
        done = space_robot(*command)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "warning" not in done.stderr


def test_a_robot_of_ones_own_runs_the_task(space_robot: Tool, tmp_path: Path) -> None:
    """The task with the robot put in, and its joints, as the comment says."""
    space_robot("new", "robot", "my_arm")
    space_robot("new", "experiment", "my_task")
    task = (tmp_path / "my_task.yaml").read_text()
    for old, new in (("robot: mini ", "robot: my_arm.yaml "), ("joint2", "shoulder"), ("joint3", "elbow")):
        assert old in task
        task = task.replace(old, new)
    (tmp_path / "my_task.yaml").write_text(task)
    done = space_robot("run", "my_task.yaml")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("law", "taken"), "NAME: is there already; got 'taken.py'"),
        (("robot", "taken"), "NAME: is there already; got 'taken.urdf'"),
        (("law", "9th"), "NAME: no name; got '9th'"),
        (("law", "none/here"), "cannot be written"),
        (("node", "mine"), "KIND: no such kind; got 'node'; accepted: experiment, law, robot, study"),
    ],
)
def test_nothing_is_written_where_it_cannot_be(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, str], said: str
) -> None:
    """One line, exit code 2, and no file of a person is touched."""
    for name in ("taken.py", "taken.urdf"):
        (tmp_path / name).write_text("mine")
    done = space_robot("new", *arguments)
    assert done.returncode == 2
    assert said in done.stderr
    there = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert there == dict.fromkeys(("taken.py", "taken.urdf"), "mine")
