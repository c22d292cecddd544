"""The same tree in the ``src/`` of a ROS workspace: colcon builds it, and what it installs runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.distribution import copy_source, executables, foreign_environment, make_venv
from tests.support.follow import ended, said_by

pytest.importorskip("rclpy")
from space_robot_bringup.modes.context import reserved_domain
from space_robot_msgs_py.log.reader import LogReader

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.xdist_group("colcon")]

# Setuptools of Ubuntu 24.04, with which Jazzy is built.
TOOLS = ["colcon-core>=0.18,<1", "colcon-ros>=0.5,<1", "colcon-python-setup-py>=0.2.9,<1", "setuptools==68.1.2"]
NODES = ("space_robot_sim/recorder", "space_robot_control/guidance", "space_robot_control/computed_torque_controller")


@pytest.fixture(scope="module")
def colcon(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The build tool, in an environment of its own."""
    return make_venv(tmp_path_factory.mktemp("colcon") / "venv", TOOLS) / "bin" / "colcon"


@pytest.mark.parametrize("option", ["--merge-install", "--symlink-install"])
def test_a_workspace_builds_and_its_nodes_run(colcon: Path, tmp_path: Path, option: str) -> None:
    """After ``colcon build`` and sourcing, all executables are there and four of them leave a complete log."""
    copy_source(tmp_path / "src" / "space_robot")
    build = [str(colcon), "build", option]
    done = subprocess.run(build, cwd=tmp_path, env=foreign_environment(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    environment = _sourced(tmp_path)
    prefix = Path(environment["AMENT_PREFIX_PATH"].split(":")[0])
    assert prefix.is_relative_to(tmp_path / "install")
    assert sorted(path.relative_to(prefix / "lib").as_posix() for path in prefix.glob("lib/space_robot_*/*")) == (
        executables()
    )
    assert (prefix / "share" / "space_robot_bringup" / "launch" / "experiment.launch.py").exists()
    assert _run_short(prefix, environment, tmp_path / "run").end_reason == "completed"


def _sourced(workspace: Path) -> dict[str, str]:
    """What the environment is after ``. install/setup.sh``; ``python3`` is that of the tests."""
    path = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    said = subprocess.run(
        ["sh", "-c", ". install/setup.sh && env -0"],
        cwd=workspace, env=foreign_environment(PATH=path), capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    return dict(line.split("=", 1) for line in said.split("\0") if line)


def _run_short(prefix: Path, environment: dict[str, str], run: Path) -> LogReader:
    arguments = ["--experiment", "point_to_point/ur5_sat", "--out", str(run), "--set", "duration=1.0"]
    with reserved_domain() as domain:
        children = [
            subprocess.Popen(
                [str(prefix / "lib" / node), *arguments],
                # Compiling what runs for one second would take a minute.
                env=environment | {"ROS_DOMAIN_ID": str(domain), "NUMBA_DISABLE_JIT": "1"},
                stderr=subprocess.PIPE,
                text=True,
                cwd=run.parent,
            )
            for node in (*NODES, "space_robot_sim/simulator")
        ]
        with ended(children):
            said = said_by(children)
    assert [child.returncode for child in children] == [0] * len(children), said
    return LogReader(run)
