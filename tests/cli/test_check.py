"""`space-robot check` says everything that is wrong with a file, at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.compose.diagnosis import NEUTRAL, diagnose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_description.share import shipped
from tests.support.tool import Tool

BASE = """
robot: mini
control_period: 0.25
duration: 10.0
"""


def said(space_robot: Tool, folder: Path, text: str) -> list[str]:
    """The lines of a check that fails."""
    (folder / "file.yaml").write_text(BASE + text, encoding="utf-8")
    done = space_robot("check", "file.yaml")
    assert done.returncode == 2, done.stdout
    assert "Traceback" not in done.stderr
    return done.stderr.splitlines()


def test_every_key_that_does_not_fit_is_a_line(space_robot: Tool, tmp_path: Path) -> None:
    """Unknown ones, wrong ones, in whatever section; nothing is left for a second try."""
    text = "sead: 1\nreference: {kind: hold}\nplant: {delay_periods: 3}\ninitial: {position: [1, 2]}\n"
    lines = said(space_robot, tmp_path, text)
    assert len(lines) == 3
    for line, word in zip(lines, ("sead", "initial.position", "plant.delay_periods"), strict=True):
        assert line.startswith(f"space-robot: file.yaml {word}: ")
        assert "more)" not in line
        assert "Input" not in line
    assert "at least 3 values, not 2" in lines[1]


def test_what_cannot_be_composed_is_found_in_every_section(space_robot: Tool, tmp_path: Path) -> None:
    """A target beyond a limit, wrong gains, a wrong joint of a fault, a wrong axis, metrics that are not there."""
    text = """
reference: {kind: step, joints_deg: {joint2: 900}}
controller: {law: computed_torque, gains: {bandwith: 1.0, damping: -1}}
faults: [{kind: joint_stuck, joint: joint9, at: 1.0}]
settling_bands: {base/rol: 1.0, joint1: 0.5}
"""
    lines = said(space_robot, tmp_path, text)
    words = ("joint2", "controller.gains.bandwith", "controller.gains.damping", "joint9", "base/rol")
    assert len(lines) == len(words), lines
    for line, word in zip(lines, words, strict=True):
        assert word in line
    expect = "expect: {joint9.final_error: {max: 1}, rate: {max: 2}}\n"
    lines = said(space_robot, tmp_path, "reference: {kind: hold}\n" + expect)
    assert len(lines) == 2
    assert ["joint9.final_error" in lines[0], "rate" in lines[1]] == [True, True]


def test_a_wrong_schema_hides_nothing(space_robot: Tool, tmp_path: Path) -> None:
    """What is misspelt or of a wrong type in one section keeps no other from being looked at, nor its own entries."""
    text = """
sead: 1
reference: {kind: hold}
initial: {position: [1, 2], joints_deg: {joint9: 3}}
controller: {law: computed_torque, gains: {bandwith: 1.0, damping: -1}}
faults: [{kind: joint_stuck, joint: joint8, at: 1.0}, {kind: nope}]
settling_bands: {base/rol: 1.0, joint1: x}
expect: {rate: {maximum: 2}}
"""
    words = [
        *("sead", "initial.position", "faults.1", "settling_bands.joint1", "expect.rate.maximum"),
        *("joint9", "gains.bandwith", "gains.damping", "joint8", "base/rol"),
    ]
    lines = said(space_robot, tmp_path, text)
    assert len(lines) == len(words), lines
    assert [[word for line in lines if word in line] for word in words] == [[word] for word in words]


@pytest.mark.parametrize("wrong", ["control_period: x", "duration: 10.1"])
def test_a_wrong_time_base_hides_what_does_not_depend_on_it(space_robot: Tool, tmp_path: Path, wrong: str) -> None:
    """Joints and gains are looked at; what has times in it is not, because it may only be wrong by them."""
    key = wrong.partition(":")[0]
    (tmp_path / "file.yaml").write_text(
        "\n".join([*(line for line in BASE.splitlines() if not line.startswith(key)), wrong])
        + """
reference: {kind: hold}
initial: {joints_deg: {joint9: 3}}
controller: {law: computed_torque, gains: {bandwith: 1.0}, switches: [{time: 0.3, to: computed_torque}]}
"""
    )
    lines = space_robot("check", "file.yaml", "--fault", "joint_stuk joint=joint1 at=1").stderr.splitlines()
    assert len(lines) == 4, lines
    assert [key in lines[0], "bandwith" in lines[1], "joint9" in lines[2], "joint_stuk" in lines[3]] == [True] * 4


def test_what_is_misspelt_is_not_missed_elsewhere(space_robot: Tool, tmp_path: Path) -> None:
    """Faults under a misspelt name: what is expected of their events is not judged without them."""
    text = """
reference: {kind: hold}
fault: [{kind: joint_stuck, joint: joint1, at: 1.0, name: stuck}]
expect: {events: {stuck: {at_least: 1}}}
"""
    (line,) = said(space_robot, tmp_path, text)
    assert line.startswith("space-robot: file.yaml fault: unknown key")


def test_a_complaint_that_follows_from_another_is_not_made(space_robot: Tool, tmp_path: Path) -> None:
    """A wrong fault has no events; what is expected of them is another matter."""
    text = """
reference: {kind: hold}
faults: [{kind: joint_stuck, joint: joint9, at: 1.0, name: stuck}]
expect: {events: {stuck: {at_least: 1}}}
"""
    (line,) = said(space_robot, tmp_path, text)
    assert "joint9" in line


@pytest.mark.parametrize("name", [name for name in shipped("experiments") if name.startswith(("liu", "switch"))])
def test_a_good_experiment_has_no_problem(name: str) -> None:
    """What composes is not looked at section by section."""
    diagnose(load_experiment(name))


def test_every_section_is_looked_at() -> None:
    """A new section of an experiment has to be put where it belongs."""
    scalar = {"title", "source", "robot", "control_period", "duration", "seed"}
    assert set(NEUTRAL) | scalar == set(Experiment.model_fields)
