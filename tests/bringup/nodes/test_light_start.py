"""What a process of one node does not load."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy")
PROGRAM = """
import json, os, sys
from space_robot_bringup.nodes import process

def loaded(*arguments, **options):
    print(json.dumps(sorted({name.split(".")[0] for name in sys.modules})), flush=True)
    os._exit(0)

process._spin = loaded
for role in ("recorder", "guidance"):
    if not os.fork():
        process.main([role, "--out", sys.argv[1], "--set", "duration=0.5"])
    os.wait()
"""


@pytest.mark.ros
def test_nodes_that_call_no_kernel_load_no_compiler(tmp_path: Path) -> None:
    """Recorder and guidance check the experiment, its law included, and are ready without numba."""
    command = [sys.executable, "-c", PROGRAM, str(tmp_path / "run")]
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env=os.environ | {"ROS_DOMAIN_ID": "0"}, timeout=120
    )
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('["')]
    assert len(lines) == 2, done.stderr
    for names in lines:
        assert {"rclpy", "pinocchio"} <= set(names)
        assert not {"numba", "llvmlite", "scipy"} & set(names)
