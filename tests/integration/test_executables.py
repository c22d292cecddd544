"""The executables that a package offers beside ``controller``, each with its own law."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from space_robot_bringup.modes.context import reserved_domain
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import Spawn, said_by
from tests.support.logged_law import law_of
from tests.support.paths import ROOT

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize(("name", "block"), [("adaptive", "parameters"), ("ntsmc", "adaptive_gain")])
def test_the_executable_runs_an_experiment_of_another_law(tmp_path: Path, spawn: Spawn, name: str, block: str) -> None:
    """With simulator, guidance and recorder beside it, the executable runs its law, and the log has its telemetry."""
    run = tmp_path / "run"
    common = ["--experiment", "point_to_point/ur5_sat", "--out", str(run), "--set", "duration=5.0"]
    law = ["--set", f"controller.law={name}"]
    nodes = {"space_robot_sim": ("recorder", "simulator"), "space_robot_control": ("guidance", f"{name}_controller")}
    with reserved_domain() as domain:
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain), "PATH": f"{_bin()}:{os.environ['PATH']}"}
        children = [
            spawn(
                ["sh", str(ROOT / "lib" / package / node), *common, *([] if node.endswith("_controller") else law)],
                env=environment,
                stderr=subprocess.PIPE,
            )
            for package, names in nodes.items()
            for node in names
        ]
        said = said_by(children)
    assert [child.returncode for child in children] == [0, 0, 0, 0], said
    reader = LogReader(run)
    assert reader.end_reason == "completed"
    assert law_of(reader.header.experiment) == name
    assert block in reader.arrays().controller


def _bin() -> Path:
    """Where ``python3`` is this interpreter: in the source tree the executables have none beside them."""
    return Path(sys.executable).parent
