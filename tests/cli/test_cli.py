"""The command line as its users meet it: results, JSON, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from space_robot_cli.schemas.made import made_schema
from tests.support.tool import Tool, refused

FIG08 = """
title: test
robot: mini
control_period: 0.25
duration: 2.0
initial: {joints_deg: [90, 45, 45, 0]}
reference: {kind: step, attitude_deg: [10, 0, 0]}
"""
URDF = """<robot name="two"><link name="hull"><inertial><mass value="{mass}"/>{inertia}</inertial></link>
<joint name="hinge" type="revolute"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="arm"><inertial><mass value="{arm}"/>{arm_inertia}</inertial></link></robot>"""
INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
ROBOT = """
name: two
urdf: two.urdf
base_mode: free_floating
actuators: {joints: {effort: 1.0}, base_torque: {kind: ideal, limit: [1, 1, 1]}}
"""


def test_run_prints_a_verdict_and_json_says_the_same(space_robot: Tool, tmp_path: Path) -> None:
    """A fine run exits 0; with --json stdout is one object that holds the verdict and no NaN."""
    done = space_robot("run", "liu2023/fig08", "--out", "bag", "--json")
    assert done.returncode == 0, done.stderr
    verdict = json.loads(done.stdout)
    assert verdict["passed"] is True
    assert verdict["end_reason"] == "completed"
    assert verdict["ticks"] == 161
    assert verdict["metrics"]["base/roll.settling_time"] == pytest.approx(6.0, abs=1.0)
    plain = space_robot("run", "liu2023/fig08", "--out", "bag", "--overwrite")
    assert plain.returncode == 0
    assert "PASS (completed)" in plain.stdout


def test_a_failed_expectation_exits_1(space_robot: Tool, tmp_path: Path) -> None:
    """A run that misses a bound of its experiment says which and exits 1."""
    done = space_robot("run", "liu2023/fig08", "--set", "expect={base/roll.final_error: {max: 0}}")
    assert done.returncode == 1
    assert "failed: base/roll.final_error" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "nowhere.yaml"), ("nowhere.yaml",)),
        (("run", "liu2023/fig8"), ("liu2023/fig8", "liu2023/fig08")),
        (("run", "liu2023/fig08", "--mode", "warp"), ("--mode", "warp", "headless")),
        (("run", "liu2023/fig08", "--realtime", "1"), ("--realtime",)),
        (("run", "liu2023/fig08", "--mode", "graph", "--realtime", "nan"), ("--realtime", "nan")),
        (("run", "liu2023/fig08", "--duration", "1.1"), ("duration", "1.1", "control_period")),
        (("run", "liu2023/fig08", "--duration", "nan"), ("nan",)),
        (("run", "liu2023/fig08", "--set", "contol_period=1"), ("contol_period", "control_period")),
        (("run", "liu2023/fig08", "--set", "controller.gains.lamda=1"), ("lamda", "lambda")),
        (("run", "liu2023/fig08", "--set", "control_period=-1"), ("control_period", "-1")),
        (("run", "liu2023/fig08", "--set", "control_period=.nan"), ("control_period",)),
        (("run", "liu2023/fig08", "--set", "controller.law=wizardry"), ("wizardry", "computed_torque")),
        (("run", "liu2023/fig08", "--set", "plant.delay_periods=2"), ("plant.delay_periods", "2")),
        (("run", "liu2023/fig08", "--set", "nonsense"), ("--set", "nonsense")),
        (("run", "liu2023/fig08", "--set", "expect={roll: {max: 1}}"), ("expect.roll",)),
        (("check", "liu2023/fig08", "--set", "initial.joints_deg=[1, 2]"), ("initial.joints_deg",)),
        (("check", "liu2023/fig08", "--set", "robot=minni"), ("minni", "mini")),
        (("robot", "minni"), ("minni", "mini")),
        (("check", "liu2023", "--set", "seed=1"), ("--set", "paper")),
        (("check", "liu2023/fig08", "--kind", "poem"), ("--kind", "poem", "campaign")),
        (("check", "liu2023/fig08", "--kind", "campaign"), ("liu2023/fig08", "campaign")),
        (("schema", "poem"), ("poem", "paper")),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_bad_input_gets_one_line_and_exit_2(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """Every mistake is named with its key, its value and what would do, on one line."""
    done = space_robot(*arguments)
    refused(done, *words)
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"arm": "-1"}, ("arm", "-1")),
        ({"arm_inertia": ""}, ("arm", "inertia")),
        ({"arm_inertia": INERTIA.replace('izz="1"', 'izz="9"')}, ("arm", "triangle")),
        ({"arm": "nan"}, ("arm", "nan")),
        ({"mass": "0"}, ("base_link", "mass")),
    ],
)
def test_an_impossible_robot_is_refused_by_its_link(
    space_robot: Tool, tmp_path: Path, numbers: dict[str, str], words: tuple[str, ...]
) -> None:
    """Negative mass, missing or impossible inertia, NaN: one line with the link's name."""
    fill = {"mass": "10", "inertia": INERTIA, "arm": "1", "arm_inertia": INERTIA} | numbers
    (tmp_path / "two.urdf").write_text(URDF.format(**fill))
    (tmp_path / "two.yaml").write_text(ROBOT)
    refused(space_robot("robot", "two.yaml"), *words)


@pytest.mark.parametrize(
    ("what", "said"),
    [
        (("fig08_dispersed",), ("100 cases", "draws initial.attitude_deg")),
        (("giordano2023/sec5",), ("servicer", "loop gain")),
        (("giordano2023/sec5", "--kind", "campaign"), ("100 cases",)),
        (("mine.yaml",), ("2 cases, 2 points", "varies control_period: 0.25, 0.5")),
    ],
    ids=lambda value: " ".join(value),
)
def test_check_knows_what_a_file_is(
    space_robot: Tool, tmp_path: Path, what: tuple[str, ...], said: tuple[str, ...]
) -> None:
    """Experiment or campaign, by the keys of the file or the name; where a name is both, --kind decides."""
    (tmp_path / "mine.yaml").write_text("experiment: liu2023/fig08\nruns: 1\nvary: {control_period: [0.25, 0.5]}\n")
    done = space_robot("check", *what)
    assert done.returncode == 0, done.stderr
    assert all(words in done.stdout for words in said), done.stdout


@pytest.mark.parametrize("kind", ["experiment", "campaign", "paper"])
def test_every_kind_of_file_has_a_schema(space_robot: Tool, kind: str) -> None:
    """The schema is what the models say today: if not, run python -m space_robot_cli.schemas."""
    said = space_robot("schema", kind).stdout
    assert json.loads(said)["type"] == "object"
    assert said == made_schema(kind)


def test_a_broken_yaml_is_refused_with_its_place(space_robot: Tool, tmp_path: Path) -> None:
    """A YAML error names file, line and column; a key given twice is an error too."""
    (tmp_path / "broken.yaml").write_text("robot: mini\ncontrol_period: [0.25\nduration: 1\n")
    refused(space_robot("check", "broken.yaml"), "broken.yaml", "line")
    (tmp_path / "twice.yaml").write_text(FIG08 + "duration: 3.0\n")
    refused(space_robot("check", "twice.yaml"), "twice.yaml", "duration")


def test_a_directory_of_something_else_is_not_overwritten(space_robot: Tool, tmp_path: Path) -> None:
    """A run never deletes what is not a run."""
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("years")
    done = space_robot("run", "liu2023/fig08", "--out", "precious")
    refused(done, "precious")
    assert (tmp_path / "precious" / "thesis.tex").read_text() == "years"


@pytest.mark.parametrize("arguments", [("--help",), ("run", "--help"), ("list",), ("robot", "mini")])
def test_the_tool_explains_itself(space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    """Help, list and robot print something useful and exit 0."""
    done = space_robot(*arguments)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) > 3


def test_a_copied_experiment_runs_with_another_arm(space_robot: Tool, tmp_path: Path) -> None:
    """The UR5 experiment, copied, with only the robot changed, runs the Panda; both arrive."""
    from space_robot_bringup.experiment.experiment import experiment_path

    text = experiment_path("point_to_point/ur5_sat").read_text()
    assert "robot: ur5_sat" in text
    (tmp_path / "ur5.yaml").write_text(text)
    (tmp_path / "panda.yaml").write_text(text.replace("robot: ur5_sat", "robot: panda_sat"))
    for name, joints in (("ur5", 6), ("panda", 7)):
        done = space_robot("run", f"{name}.yaml", "--json")
        assert done.returncode == 0, done.stdout + done.stderr
        errors = [value for key, value in json.loads(done.stdout)["metrics"].items() if key.endswith(".final_error")]
        assert len(errors) == 3 + joints
        assert max(errors) < 0.05


def test_the_tool_runs_as_a_program(tmp_path: Path) -> None:
    """Started as its own process: a mistake is one line and exit 2, and nothing of Python shows."""
    command = [sys.executable, "-m", "space_robot_cli", "run", "liu2023/fig8"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False, timeout=120)
    refused(done, "liu2023/fig8", "liu2023/fig08")
