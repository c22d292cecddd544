"""One executable of a package as a user starts it, and the other nodes of its run as forks."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from space_robot_bringup.modes.context import reserved_domain
from tests.support.follow import Spawn, ended, said_by
from tests.support.forks import fork_main
from tests.support.paths import ROOT

PROGRAM = "space_robot_bringup.nodes.process"
OTHERS = ("recorder", "simulator", "guidance")


def run_beside(spawn: Spawn, executable: str, common: Sequence[str], *, others: Sequence[str] = ()) -> None:
    """Run an experiment to its end.

    Args:
        spawn: fixture.
        executable: ``package/name`` of a controller.
        common: arguments of all nodes.
        others: arguments of the other nodes alone.
    """
    with reserved_domain() as domain:
        # In the source tree the executables have no ``python3`` beside them: this interpreter is theirs.
        path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain), "PATH": path}
        command = ["sh", str(ROOT / "lib" / executable), *common]
        controller = spawn(command, env=environment, stderr=subprocess.PIPE)
        forks = [fork_main(PROGRAM, role, *common, *others, environment=environment) for role in OTHERS]
        with ended(forks):
            said = [*said_by([controller]), *said_by(forks)]
    assert [child.returncode for child in (controller, *forks)] == [0, 0, 0, 0], said
