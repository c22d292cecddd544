"""What a command need not load, it does not load: each command by itself, in a process that had loaded nothing."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from space_robot_description.kernel import jit
from tests.support.paths import ROOT
from tests.support.tool import Tool

COMPILER = {"numba", "llvmlite", "scipy"}
LOGS = {"mcap", "rosbags", "zstandard"}
NUMBERS = {"numpy", "pinocchio", "yaml"}
GRAPH = {"rclpy", "matplotlib", "plotly", "viser", "distributed", "pandas"}
# By what is typed: the libraries that stay out.
STAY_OUT = {
    "--version": {*COMPILER, *LOGS, *NUMBERS, *GRAPH, "pydantic"},
    "--help": {*COMPILER, *LOGS, *NUMBERS, *GRAPH, "pydantic"},
    "list": {*COMPILER, *LOGS, *GRAPH, "numpy", "pinocchio", "rich"},
    "robot servicer": {*COMPILER, *LOGS, *GRAPH},
    "schema": {*COMPILER, *LOGS, *NUMBERS, *GRAPH, "rich"},
    "check giordano2023/sec5": {*COMPILER, *LOGS, *GRAPH, "rich"},
    "info tests/data/golden/adaptive_mini": {*COMPILER, *GRAPH},
}
# A fork per command: the process before it has loaded what Python itself loads.
PROGRAM = """
import io, json, os, sys
found = {}
for typed in json.loads(sys.argv[1]):
    ours, theirs = os.pipe()
    child = os.fork()
    if not child:
        sys.stdout = said = io.StringIO()
        sys.argv = ["space-robot", *typed.split()]
        from space_robot_cli.main import main
        try:
            main()
        except SystemExit as end:
            names = sorted({name.split(".")[0] for name in sys.modules})
            with open(theirs, "w") as pipe:
                json.dump([end.code, names, said.getvalue()], pipe)
        os._exit(0)
    os.close(theirs)
    with open(ours) as pipe:
        found[typed] = json.load(pipe)
    os.waitpid(child, 0)
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def ends() -> dict[str, tuple[int, list[str], str]]:
    """Exit code, loaded libraries and output of each command."""
    command = [sys.executable, "-c", PROGRAM, json.dumps(list(STAY_OUT))]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    found: dict[str, tuple[int, list[str], str]] = json.loads(done.stdout)
    return found


def test_commands_load_nothing_that_they_do_not_use(ends: dict[str, tuple[int, list[str], str]]) -> None:
    """The quick ones no compiler, no reader of logs and no graph; help and version not even NumPy."""
    assert {typed: code for typed, (code, *_) in ends.items()} == dict.fromkeys(STAY_OUT, 0)
    assert {typed: sorted(STAY_OUT[typed].intersection(names)) for typed, (_, names, _) in ends.items()} == {
        typed: [] for typed in STAY_OUT
    }


def test_a_check_without_the_compiler_says_the_same(
    ends: dict[str, tuple[int, list[str], str]], space_robot: Tool
) -> None:
    """Here, where kernels are loaded, the command calls compiled ones."""
    assert jit.COMPILED == jit.INSTALLED
    typed = "check giordano2023/sec5"
    assert ends[typed][2] == space_robot(*typed.split()).stdout
