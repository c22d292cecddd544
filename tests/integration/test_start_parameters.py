"""Nodes of their own processes started as ROS starts nodes: by parameters, from files, in namespaces, by remapping."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from space_robot_bringup.compose.parameters import overrides_from
from space_robot_bringup.nodes.arguments import Start, start_from
from space_robot_msgs_py.errors import SpecError
from tests.support.paths import ROOT

pytest.importorskip("rclpy")
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import reserved_domain
from space_robot_bringup.modes.graph import MANAGED
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import DEADLINE, Child, ended, said_by
from tests.support.forks import Fork, fork_main

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

NODE = "space_robot_bringup.nodes.process"
Starter = Callable[..., Fork]
ROLES = ("recorder", "guidance", "controller", "simulator")
LAW = "examples/my_law.py:PdPlus"
PARAMETERS = f"""
/**:
  ros__parameters:
    experiment: liu2023/fig08
    law: {ROOT / LAW}
    gains.bandwidth: 0.6
    duration: 5.0
    set: [seed=3]
"""


@pytest.fixture
def start() -> Iterator[Starter]:
    """Starts one node in a fork; none survives the test."""
    children: list[Fork] = []

    def begin(role: str, domain: int, *arguments: str) -> Fork:
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        children.append(fork_main(NODE, role, *arguments, cwd=ROOT, environment=environment))
        return children[-1]

    with ended(children):
        yield begin


def start_program(role: str, domain: int, *arguments: str) -> subprocess.Popen[str]:
    """Starts one node as a program of its own."""
    environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
    command = [sys.executable, "-m", NODE, role, *arguments]
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True, cwd=ROOT)


def all_well(children: Sequence[Child]) -> None:
    """They all end with 0."""
    said = said_by(children)
    assert [child.returncode for child in children] == [0] * len(children), said


def test_a_parameter_file_starts_a_third_party_law(tmp_path: Path, start: Starter) -> None:
    """Nodes given experiment, law, gains and overrides by --params-file leave the bits of a run with the same."""
    file, run = tmp_path / "parameters.yaml", tmp_path / "run"
    file.write_text(PARAMETERS)
    given = ["--ros-args", "--params-file", str(file), "-p", f"out:={run}"]
    with reserved_domain() as domain, ended([start_program("controller", domain, *given)]) as controller:
        all_well([start(role, domain, *given) for role in ROLES if role != "controller"])
        all_well(controller)
    sets = [f"controller.law={ROOT / LAW}", "controller.gains.bandwidth=0.6", "duration=5.0", "seed=3"]
    run_experiment(load_experiment("liu2023/fig08", sets), tmp_path / "same" / "run", mode="headless")
    same = LogReader(tmp_path / "same" / "run")
    assert list(LogReader(run).messages()) == list(same.messages())
    assert LogReader(run).header.experiment == same.header.experiment


def test_nodes_that_wait_are_brought_up_by_the_manager(tmp_path: Path, start: Starter) -> None:
    """With autostart off nothing runs until the manager has configured it; then it is the usual run."""
    run, waiting = tmp_path / "run", ["--ros-args", "-p", "autostart:=false"]
    with reserved_domain() as domain:
        children = [
            start(role, domain, "--out", str(run), "--set", "duration=5.0", *(waiting if role in MANAGED else []))
            for role in ROLES
        ]
        manager = [sys.executable, "-m", "space_robot_bringup.nodes.lifecycle_manager"]
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        done = subprocess.run(manager, env=environment, capture_output=True, text=True, timeout=DEADLINE, check=False)
        assert done.returncode == 0, done.stderr
        all_well(children)
        alone = fork_main("space_robot_bringup.nodes.lifecycle_manager", "--patience", "0.5", environment=environment)
        with ended([alone]):
            said = alone.communicate(timeout=DEADLINE)[1]
    assert alone.returncode == 1
    assert "controller/get_state: does not answer" in said
    run_experiment(load_experiment("liu2023/fig08", ["duration=5.0"]), tmp_path / "same" / "run", mode="headless")
    assert list(LogReader(run).messages()) == list(LogReader(tmp_path / "same" / "run").messages())


def test_two_robots_on_one_domain_do_not_hear_each_other(tmp_path: Path, start: Starter) -> None:
    """Each in its namespace, on one domain at the same time, they run what each would run alone."""
    plans = {"alpha": ["duration=5.0"], "beta": ["duration=5.0", "controller.gains.kappa=0.5"]}
    with reserved_domain() as domain:
        all_well(
            [
                start(role, domain, "--out", str(tmp_path / name), *_sets(sets), "--ros-args", "-r", f"__ns:=/{name}")
                for name, sets in plans.items()
                for role in ROLES
            ]
        )
    for name, sets in plans.items():
        run_experiment(load_experiment("liu2023/fig08", sets), tmp_path / "same" / name, mode="headless")
        together, alone = LogReader(tmp_path / name), LogReader(tmp_path / "same" / name)
        assert list(together.messages()) == list(alone.messages())


def test_topics_can_be_remapped_and_their_quality_overridden(tmp_path: Path, start: Starter) -> None:
    """With the commands under other names at both ends, and another depth by parameter, the run is the same."""
    remapped = [
        *("--ros-args", "-r", "joint_command:=arm/effort", "-r", "base/wrench_command:=bus/wrench"),
        *("-p", "qos_overrides./arm/effort.publisher.depth:=500"),
    ]
    run = tmp_path / "run"
    with reserved_domain() as domain:
        all_well([start(role, domain, "--out", str(run), "--set", "duration=5.0", *remapped) for role in ROLES])
    run_experiment(load_experiment("liu2023/fig08", ["duration=5.0"]), tmp_path / "same" / "run", mode="headless")
    assert list(LogReader(run).messages()) == list(LogReader(tmp_path / "same" / "run").messages())


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["-p", "experiment:=nowhere"], "nowhere"),
        (["-p", "gains.kapa:=1.0"], "parameter gains.kapa: unknown key"),
        (["-p", "gains.lambda.joint:=1.0"], "parameter gains.lambda.joint"),
        (["-p", "law:=nothing"], "no such law"),
        (["-p", "realtime:=fast"], "parameter realtime"),
        (["-p", "colour:=red"], "colour"),
        (["--params-file", "/nowhere.yaml"], "--ros-args"),
        (["-p", "gains.kappa:={a"], "--ros-args"),
    ],
)
def test_impossible_parameters_are_refused_in_one_line(start: Starter, arguments: list[str], why: str) -> None:
    """Exit code 2, the key and the reason, no traceback, and nothing is left behind."""
    with reserved_domain() as domain:
        child = start("controller", domain, "--ros-args", *arguments)
        said = child.communicate(timeout=DEADLINE)[1]
    assert child.returncode == 2, said
    assert why in said
    assert "Traceback" not in said


def test_the_command_line_counts_more_than_parameters() -> None:
    """Of both only what the command line does not say comes from parameters; keys of the experiment are overrides."""
    options = {"role": "controller", "out": "there", "set": ["seed=2"], "progress": False}
    given = {"out": "here", "realtime": 2.0, "set": ["seed=1"], "law": "ntsmc", "plant.delay_periods": 1}
    sets = ("controller.law=ntsmc", "plant.delay_periods=1", "seed=1", "seed=2")
    assert start_from(options, given) == Start(out="there", realtime=2.0, set=sets)


def test_values_keep_their_type_on_the_way_into_the_experiment() -> None:
    """Numbers, lists and truth values arrive as such, texts as YAML."""
    given = {"gains.lead": True, "initial.joints_deg": [1.0, 2.0], "title": "a: b", "gains.rho": "null"}
    assert list(overrides_from(given).values()) == [
        "controller.gains.lead=true",
        "initial.joints_deg=[1.0, 2.0]",
        'title="a: b"',
        "controller.gains.rho=null",
    ]
    with pytest.raises(SpecError, match="no value"):
        overrides_from({"seed": None})


def _sets(overrides: list[str]) -> list[str]:
    return [part for override in overrides for part in ("--set", override)]
