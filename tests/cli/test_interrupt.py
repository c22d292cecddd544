"""A signal ends every command of many runs in one line, whatever it is doing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.support.paths import ROOT

SIGNALS = (signal.SIGINT, signal.SIGTERM)
# Says that it is being made, and never is: as a law that is compiled for ever.
SLOW = """
import os
from threading import Event
from space_robot_control.laws import Law

class Slow(Law):
    def __init__(self, *arguments):
        os.write(2, b"being made\\n")
        while True:
            pass

    def compute(self, state, reference):
        raise AssertionError
"""
CAMPAIGN = """
experiment: liu2023/fig08
set: {duration: 2.0, settling_bands: {base/roll: 1.0}}
runs: 1
vary: {controller: {slow: {law: "slow.py:Slow"}}}
"""
PAPER = """
title: t
citation: c
figures: {8: {title: t, runs: {x: {experiment: liu2023/fig08, set: {controller: {law: "slow.py:Slow"}}}}}}
"""


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize(
    "arguments", [("campaign", "slow.yaml"), ("compare", "slow.yaml"), ("reproduce", "paper.yaml")], ids=lambda a: a[0]
)
def test_a_study_can_be_interrupted_while_it_is_checked(
    tmp_path: Path, arguments: Sequence[str], number: signal.Signals
) -> None:
    """Before the first run, too, a signal ends the command with exit 1, one line and nothing written."""
    for name, text in (("slow.py", SLOW), ("slow.yaml", CAMPAIGN), ("paper.yaml", PAPER)):
        (tmp_path / name).write_text(text)
    before = set(tmp_path.iterdir())
    command = [sys.executable, "-m", "space_robot_cli", *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as tool:
        assert tool.stderr is not None
        assert tool.stderr.readline() == "being made\n"
        os.killpg(tool.pid, number)
        said = tool.stderr.read().replace("being made\n", "")
        assert tool.wait(timeout=60) == 1, said
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert said.splitlines() == [f"{word}: finished runs are kept; go on with --resume"]
    assert {path for path in tmp_path.iterdir() if path.name != "__pycache__"} == before


@pytest.mark.parametrize("number", SIGNALS)
def test_any_command_ends_in_one_line(tmp_path: Path, number: signal.Signals) -> None:
    """A command without handlers of its own, such as report, says how it was ended and exits with 1."""
    program = """
import os, sys
import space_robot_cli.view_commands
from space_robot_cli import main

def wait(place, suffix):
    os.write(2, b"begun\\n")
    while True:
        pass

space_robot_cli.view_commands.beside = wait
sys.argv = ["space-robot", "report", "nothing"]
main.main()
"""
    with subprocess.Popen([sys.executable, "-c", program], cwd=ROOT, stderr=subprocess.PIPE, text=True) as tool:
        assert tool.stderr is not None
        assert tool.stderr.readline() == "begun\n"
        tool.send_signal(number)
        said = tool.stderr.read()
        assert tool.wait(timeout=60) == 1, said
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert said.splitlines() == [f"space-robot: {word}"]
