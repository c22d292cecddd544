"""A signal ends every command of many runs in one line, whatever it is doing."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from pathlib import Path

import pytest

from space_robot_cli import view_commands
from tests.support.follow import DEADLINE, ended
from tests.support.forks import Fork, fork_main, run_main

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
    with ended([fork_main("space_robot_cli.main", *arguments, cwd=tmp_path, session=True)]) as (tool,):
        tool.await_words("being made\n", DEADLINE)
        os.killpg(tool.pid, number)
        said = tool.communicate(DEADLINE)[1].replace("being made\n", "")
    assert tool.returncode == 1, said
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert said.splitlines() == [f"{word}: finished runs are kept; go on with --resume"]
    assert {path for path in tmp_path.iterdir() if path.name != "__pycache__"} == before


def wait_for_ever(*arguments: object) -> None:
    """Say that it has begun, and never end."""
    os.write(2, b"begun\n")
    while True:
        pass


def report_for_ever() -> None:
    """``space-robot report`` that does not get beyond the place of its page."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(view_commands, "beside", wait_for_ever)
        run_main("space_robot_cli.main", ["report", "nothing"])


@pytest.mark.parametrize("number", SIGNALS)
def test_any_command_ends_in_one_line(number: signal.Signals) -> None:
    """A command without handlers of its own, such as report, says how it was ended and exits with 1."""
    with ended([Fork(report_for_ever)]) as (tool,):
        tool.await_words("begun\n", DEADLINE)
        tool.send_signal(number)
        said = tool.communicate(DEADLINE)[1].replace("begun\n", "")
    assert tool.returncode == 1, said
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert said.splitlines() == [f"space-robot: {word}"]
