"""What holds for all tests, and fixtures of those that run."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from space_robot_cli.main import main

# Loaded before any test: `check` leaves kernels that nothing has loaded yet without a compiler.
from space_robot_description.kernel import jit  # noqa: F401
from tests.support.follow import Spawn, ended
from tests.support.tool import Tool

# The messages of the wheels check no types unless this is there when they are imported, here and in every process.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
# Every test takes a domain that is free: one that is set here would be the same for all that run beside each other.
os.environ.pop("ROS_DOMAIN_ID", None)

# Groups of which the tests meet a clock: of nodes that run, and of other programs.
TIMED = ("graph", "hosts", "browser")
NICE = 5


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Workers of xdist that compute stand back behind those that meet a clock: there are more of them than cores."""
    group = item.get_closest_marker("xdist_group")
    if "PYTEST_XDIST_WORKER" in os.environ and os.nice(0) < NICE and (group is None or group.args[0] not in TIMED):
        os.nice(NICE)


@pytest.fixture
def spawn() -> Iterator[Spawn]:
    """Starts processes as subprocess.Popen does, with text; none outlives the test, nor do its pipes."""
    children: list[subprocess.Popen[str]] = []

    def start(command: list[str], **options: Any) -> subprocess.Popen[str]:
        # What lives on a domain of this test holds it until its end.
        context = sys.modules.get("space_robot_bringup.modes.context")
        options.setdefault("pass_fds", context.reservations() if context else ())
        children.append(subprocess.Popen(command, text=True, **options))
        return children[-1]

    with ended(children):
        yield start


@pytest.fixture
def space_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Tool:
    """The tool's own entry point in an empty folder; in this process, because importing it takes longer than a run."""

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["space-robot", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        said = capsys.readouterr()
        assert isinstance(end.value.code, int)
        return subprocess.CompletedProcess(arguments, end.value.code, said.out, said.err)

    return call
