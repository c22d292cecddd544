"""ROS launch starts the graph, and its exit code says whether the run went well."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("rclpy")
pytest.importorskip("ros2launch", reason="ROS launch is no package of the index: it comes with a ROS installation")
pytest.importorskip("launch_ros")
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import reserved_domain
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.distribution import ROOT
from tests.support.follow import DEADLINE, Spawn, await_ticks

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.xdist_group("graph")]

Launch = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def launch(tmp_path: Path, spawn: Spawn) -> Iterator[Launch]:
    """``ros2 launch`` of the source tree's launch file in an empty folder, on a domain of its own."""
    index = tmp_path / "prefix" / "share" / "ament_index" / "resource_index"
    index.mkdir(parents=True)
    (index / "packages").symlink_to(ROOT / "resource")
    (tmp_path / "prefix" / "lib").symlink_to(ROOT / "lib")
    with reserved_domain() as domain:

        def start(*arguments: str, file: str = "experiment") -> subprocess.Popen[str]:
            paths = {
                "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
                "ROS_LOG_DIR": str(tmp_path / "log"),
            }
            prefixes = f"{tmp_path / 'prefix'}:{os.environ.get('AMENT_PREFIX_PATH', sys.prefix)}"
            return spawn(
                ["ros2", "launch", str(ROOT / "launch" / f"{file}.launch.py"), *arguments],
                env=os.environ | paths | {"AMENT_PREFIX_PATH": prefixes, "ROS_DOMAIN_ID": str(domain)},
                cwd=tmp_path,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

        yield start


def test_a_complete_run_ends_with_0(launch: Launch, tmp_path: Path) -> None:
    """In a namespace, with another law and other keys; the log is that of the loop without ROS, to the byte."""
    child = launch("experiment:=liu2023/fig08", "controller:=pd", "namespace:=alpha", "set:=duration=2.0")
    said = child.communicate(timeout=DEADLINE)[0]
    assert child.returncode == 0, said
    experiment = load_experiment("liu2023/fig08", ["controller.law=pd", "duration=2.0"])
    run_experiment(experiment, tmp_path / "alone", mode="headless")
    launched, alone = (tmp_path / place for place in ("runs/fig08/fig08_0.mcap", "alone/alone_0.mcap"))
    assert launched.read_bytes() == alone.read_bytes()


def test_bad_input_ends_with_1(launch: Launch, tmp_path: Path) -> None:
    """Every node refuses what there is not, and launch passes it on."""
    child = launch("experiment:=nonsense")
    said = child.communicate(timeout=DEADLINE)[0]
    assert child.returncode == 1, said
    assert "no such experiment" in said
    assert "Traceback" not in said
    assert not (tmp_path / "runs").exists()


def test_a_node_that_dies_ends_the_run_with_1(launch: Launch, tmp_path: Path) -> None:
    """When the controller is killed, the others are ended, the log is closed, and no process is left."""
    child = launch("experiment:=liu2023/fig08", "controller:=pd", "realtime:=1.0", "set:=duration=600.0", "out:=run")
    said = _kill("controller", child, tmp_path / "run")
    assert child.returncode == 1, said
    assert "exit code -9" in said
    assert LogReader(tmp_path / "run").end_reason == "interrupted"
    with pytest.raises(ProcessLookupError):
        os.killpg(child.pid, 0)


def test_ctrl_c_ends_with_0(launch: Launch, tmp_path: Path) -> None:
    """As in a terminal, where the whole group gets the signal: an interrupted run is not a failed one."""
    child = launch("experiment:=liu2023/fig08", "controller:=pd", "realtime:=1.0", "set:=duration=600.0", "out:=run")
    _await_ticks(child, tmp_path / "run")
    os.killpg(child.pid, signal.SIGINT)
    said = child.communicate(timeout=DEADLINE)[0]
    assert child.returncode == 0, said
    assert "Traceback" not in said
    assert LogReader(tmp_path / "run").end_reason == "interrupted"


def test_a_replay_is_answered_by_a_controller(launch: Launch, tmp_path: Path) -> None:
    """The bag's states go out, the controller answers, both end with 0; a bag that is not there ends with 1."""
    experiment = load_experiment("liu2023/fig08", ["controller.law=pd", "duration=2.0"])
    run_experiment(experiment, tmp_path / "run", mode="headless")
    child = launch("bag:=run", "experiment:=liu2023/fig08", "controller:=pd", "namespace:=alpha", file="replay")
    said = child.communicate(timeout=DEADLINE)[0]
    assert child.returncode == 0, said
    child = launch("bag:=nothing", file="replay")
    said = child.communicate(timeout=DEADLINE)[0]
    assert child.returncode == 1, said
    assert "no such bag" in said


def _kill(role: str, child: subprocess.Popen[str], run: Path) -> str:
    """Kill that node of a run in progress; what launch said."""
    said = _await_ticks(child, run)
    found = re.search(rf"{role}-\d\]: process started with pid \[(\d+)\]", said)
    assert found, said
    os.kill(int(found[1]), signal.SIGKILL)
    return said + child.communicate(timeout=DEADLINE)[0]


def _await_ticks(child: subprocess.Popen[str], run: Path) -> str:
    """Read what launch says until all nodes are started, then wait for the first ticks in the log."""
    said = ""
    assert child.stdout is not None
    while said.count("process started") < 4:
        line = child.stdout.readline()
        assert line, said
        said += line
    await_ticks(run, 3, child, DEADLINE)
    return said
