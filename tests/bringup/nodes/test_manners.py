"""What a node says to who started it: its name, its version, what it waits for."""

from __future__ import annotations

import os
import runpy
import signal
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.nodes import executables, process
from space_robot_bringup.nodes.waiting import LOOK_SECONDS, WaitNotes
from space_robot_msgs_py.version import __version__
from tests.support.follow import DEADLINE, ended
from tests.support.forks import Fork
from tests.support.harness import running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize("name", ["simulator", "ntsmc_controller"])
def test_an_executable_has_its_own_name(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """In its usage, without the role that it has already, and in ``--version``."""
    for option in ("--help", "--version"):
        with pytest.raises(SystemExit) as end:
            process.main(["controller", option], name)
        assert end.value.code == 0
    said = capsys.readouterr().out
    assert f"usage: {name} [-h] [--version]" in said
    assert "{recorder" not in said
    assert f"{name} {__version__}\n" in said


def test_the_replayer_has_a_version(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """As every executable."""

    def leave(code: int) -> None:
        raise SystemExit(code)

    monkeypatch.setattr(process, "leave", leave)
    with pytest.raises(SystemExit):
        executables.start("replayer", ["--version"])
    assert capsys.readouterr().out == f"replayer {__version__}\n"


def interrupted_start(number: int) -> None:
    """The start of an executable that a signal interrupts where it would go on to import everything."""
    heavy: Any = ModuleType("heavy")
    heavy.start = lambda name, arguments: os.kill(os.getpid(), number)
    sys.modules["space_robot_bringup.nodes.executables"] = heavy
    sys.argv = ["python", "simulator"]
    runpy.run_module("space_robot_bringup.nodes", run_name="__main__")
    os._exit(7)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_it_starts_is_no_failure(number: signal.Signals) -> None:
    """Before anything heavy is imported both signals end it with 0."""
    child = Fork(interrupted_start, number)
    with ended([child]):
        said = child.communicate(timeout=DEADLINE)
    assert child.returncode == 0, said


def test_a_node_says_what_it_waits_for(tmp_path: Path) -> None:
    """A simulator without a controller names the commands, once; when they are there it says that, once."""
    now, said = 0.0, list[str]()
    with running_graph(tmp_path / "run", roles=("recorder", "guidance", "simulator")) as robot:
        robot.spin_until(lambda: robot.simulator.unheard() == ["base/wrench_command", "joint_command"], "the recorder")
    node: Any = SimpleNamespace(unheard=lambda: missing, get_logger=lambda: SimpleNamespace(info=said.append))
    missing = ["base/wrench_command", "joint_command"]
    notes = WaitNotes(node, lambda: now)
    notes.look()
    assert not said
    for _ in range(2):
        now += LOOK_SECONDS
        notes.look()
    missing = []
    for _ in range(2):
        now += LOOK_SECONDS
        notes.look()
    assert said == [
        "waiting for a publisher of base/wrench_command, joint_command",
        "hears a publisher of all it waited for",
    ]
